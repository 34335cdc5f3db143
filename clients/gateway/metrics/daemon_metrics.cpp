// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/daemon_metrics.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string_view>

namespace dts::gateway {
namespace {

constexpr double kMillisecondsPerSecond = 1e3;
constexpr double kMicrosecondsPerSecond = 1e6;
constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kPartsPerMillion = 1e6;
constexpr double kPercent = 100.0;

double number(std::uint64_t count) { return static_cast<double>(count); }

/// Converts "GAP_REASON_RING_FULL" to "ring_full".
std::string word(const google::protobuf::EnumValueDescriptor& value) {
  constexpr std::string_view kNone = "UNSPECIFIED";
  const std::size_t prefix = value.type()->value(0)->name().size() - kNone.size();
  std::string text = value.name().substr(prefix);
  std::ranges::transform(text, text.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

/// Adds one series per state, 1 for the present one, so that a change of state leaves no series with a gap.
void add_states(const Described& what, const google::protobuf::EnumDescriptor& type, int present, const MetricLabels& labels,
                Exposition& out) {
  for (int index = 1; index < type.value_count(); ++index) {
    MetricLabels with_state = labels;
    with_state.emplace_back("state", word(*type.value(index)));
    out.gauge(what, type.value(index)->number() == present ? 1.0 : 0.0, with_state);
  }
}

/// Adds every cause from the start, with 0 if it never occurred: the first loss is then an increase, which an alert rule can detect.
void add_losses(const v1::RigStatus& rig, const std::string& name, Exposition& out) {
  const google::protobuf::EnumDescriptor& causes = *v1::GapReason_descriptor();
  for (int index = 1; index < causes.value_count(); ++index) {
    const auto is_it = [reason = causes.value(index)->number()](const v1::LossCount& loss) { return loss.reason() == reason; };
    const auto counted = std::ranges::find_if(rig.losses(), is_it);
    const bool has_happened = counted != rig.losses().end();
    const MetricLabels labels{{"rig", name}, {"cause", word(*causes.value(index))}};
    out.counter({"dts_lost_scans_total", "Scans lost before the pipeline, by cause."},
                has_happened ? number(counted->lost_scans_total()) : 0.0, labels);
    out.counter({"dts_gaps_total", "Gaps in the data, by cause."}, has_happened ? number(counted->gaps_total()) : 0.0, labels);
  }
}

void add_device(const v1::RigStatus& rig, const MetricLabels& labels, Exposition& out) {
  add_states({"dts_device_state", "1 for the present state of the rig's device."}, *v1::DeviceState_descriptor(), rig.device(), labels,
             out);
  out.counter({"dts_scans_total", "Scans read from the device, including scans then lost because a queue was full."},
              number(rig.scans_total()), labels);
  out.counter({"dts_reconnects_total", "Reconnections of a lost device."}, number(rig.reconnects_total()), labels);
  out.counter({"dts_device_restarts_total", "Restarts of the scan of a connected device."}, number(rig.restarts_total()), labels);
  out.gauge({"dts_nominal_rate_hertz", "Nominal rate of the device."}, rig.nominal_rate_hz(), labels);
  out.gauge({"dts_measured_rate_hertz", "Rate over the last seconds by the host's clock; 0: no data, or unknown."}, rig.measured_rate_hz(),
            labels);
  out.gauge({"dts_clock_drift_ratio", "Drift of the device's clock: positive if fast; 0 while unknown."},
            rig.clock_drift_ppm() / kPartsPerMillion, labels);
  out.gauge({"dts_host_time_uncertainty_seconds", "Uncertainty of the host time of the newest block."},
            static_cast<double>(rig.host_time_uncertainty_ns()) / kNanosecondsPerSecond, labels);
}

prometheus::ClientMetric::Histogram latency_of(const v1::LatencyHistogram& latency) {
  prometheus::ClientMetric::Histogram histogram;
  for (const v1::LatencyHistogram::Bucket& bucket : latency.buckets()) {
    histogram.bucket.push_back({.cumulative_count = bucket.blocks_total(), .upper_bound = bucket.upper_ms() / kMillisecondsPerSecond});
    histogram.sample_count = bucket.blocks_total();  // the count of the last, infinite bucket is the total
  }
  histogram.sample_sum = latency.sum_ms() / kMillisecondsPerSecond;
  return histogram;
}

void add_flow(const v1::RigStatus& rig, const std::string& name, const MetricLabels& labels, Exposition& out) {
  out.gauge({"dts_pipeline_seconds_per_scan", "Processing time per scan, moving mean."},
            rig.pipeline_us_per_scan() / kMicrosecondsPerSecond, labels);
  const v1::RingFill& fill = rig.ring_fill();
  for (const auto& [ring, percent] : {std::pair{"frames", fill.frames_percent()}, {"record", fill.record_percent()}}) {
    out.gauge({"dts_ring_fill_ratio", "Largest fill of a queue within the last 30 s; at 1 data are dropped."}, percent / kPercent,
              {{"rig", name}, {"ring", ring}});
  }
  out.counter({"dts_dropped_blocks_total", "Blocks dropped because the publisher's queue was full."}, number(rig.dropped_blocks_total()),
              labels);
  out.counter({"dts_lost_events_total", "Triggers, reaches and classes lost because a queue was full."}, number(rig.lost_events_total()),
              labels);
  out.histogram({"dts_block_latency_seconds", "Time from a block's newest scan to the data socket."}, latency_of(rig.latency()), labels);
}

void add_session(const v1::RigStatus& rig, const MetricLabels& labels, Exposition& out) {
  const v1::SessionInfo& session = rig.session();
  add_states({"dts_session_state", "1 for the state of the rig's session, or of its last one."}, *v1::SessionState_descriptor(),
             session.state(), labels, out);
  out.gauge({"dts_recording_active", "1 while a recording runs."}, session.recording().is_recording() ? 1.0 : 0.0, labels);
  out.gauge({"dts_recording_bytes", "Size of the present recording, or of the last one."}, number(session.recording().bytes()), labels);
  out.gauge({"dts_recording_lost_scans", "Scans lost from the present recording, or from the last one."},
            number(session.recording().lost_scans_total()), labels);
  out.gauge({"dts_recording_lag_seconds", "Length of the recording that a power cut now would lose."}, rig.record_lag_s(), labels);
}

void add_disk(const v1::DiskStatus& disk, Exposition& out) {
  if (disk.state() == v1::DISK_STATE_UNSPECIFIED) return;
  add_states({"dts_disk_state", "1 for the present state of the disk of the recordings."}, *v1::DiskState_descriptor(), disk.state(), {},
             out);
  out.gauge({"dts_disk_free_bytes", "Free space on the disk of the recordings."}, number(disk.free_bytes()));
  out.gauge({"dts_disk_recordable_seconds", "Recording time left with all rigs recording."}, disk.recordable_s());
}

}  // namespace

void add_daemon(const v1::StatusSnapshot& status, Exposition& out) {
  out.gauge({"dts_daemon_info", "Version of the daemon, as a label."}, 1.0, {{"version", status.version()}});
  out.gauge({"dts_daemon_uptime_seconds", "Time since the daemon started."}, status.uptime_s());
  out.gauge({"dts_daemon_notices", "Notices in the daemon's status; dtsctl status shows them."}, status.notices_size());
  out.counter({"dts_rejected_requests_total", "Malformed control messages."}, number(status.rejected_requests_total()));
  add_disk(status.disk(), out);
  for (const v1::RigStatus& rig : status.rigs()) {
    const std::string& name = rig.rig().name();
    const MetricLabels labels{{"rig", name}};
    add_device(rig, labels, out);
    add_losses(rig, name, out);
    add_flow(rig, name, labels, out);
    add_session(rig, labels, out);
  }
}

}  // namespace dts::gateway
