// SPDX-License-Identifier: Apache-2.0
#include "ctl/health_view.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include "cli/table.h"
#include "ctl/json.h"
#include "ctl/latency.h"
#include "ctl/recording_view.h"
#include "ctl/status_view.h"

namespace dts::ctl {
namespace {

constexpr std::int64_t kLatencyWindowNs = 10'000'000'000;
constexpr std::size_t kMostSeen = 100;  ///< A status arrives every second, and after each change.
constexpr double kMedian = 0.5;
constexpr double kNearlyAll = 0.95;

std::string milliseconds_text(const std::optional<double>& ms) { return ms ? cli::decimal(*ms, 1) : "-"; }

std::string percent_text(const v1::RingFill& fill) {
  return cli::decimal(fill.frames_percent(), 0) + " " + cli::decimal(fill.record_percent(), 0);
}

/// Returns "floor: lost 150 scans in 1 gap: overrun".
std::string loss_line(const std::string& rig, const v1::LossCount& loss) {
  return rig + ": lost " + counted(loss.lost_scans_total(), "scan") + " in " + counted(loss.gaps_total(), "gap") + ": " +
         enumerator_word(*v1::GapReason_descriptor(), loss.reason());
}

std::string recording_line(const v1::RigStatus& rig) {
  const v1::RecordingStatus& recording = rig.session().recording();
  std::string line =
      rig.rig().name() + ": recording " + bytes_text(recording.bytes()) + ", " + cli::decimal(rig.record_lag_s(), 1) + " s not yet on disk";
  if (recording.lost_scans_total() > 0) line += ", " + counted(recording.lost_scans_total(), "scan") + " missing";
  return line;
}

/// Returns whether the session runs or has failed; one that has ended needs no attention.
bool is_shown(const v1::SessionInfo& session) {
  return session.state() != v1::SESSION_STATE_UNSPECIFIED && session.state() != v1::SESSION_STATE_IDLE;
}

void add_rig_lines(const v1::RigStatus& rig, std::vector<std::string>& lines) {
  const std::string& name = rig.rig().name();
  if (!rig.device_message().empty()) lines.push_back(name + ": " + rig.device_message());
  for (const v1::LossCount& loss : rig.losses()) lines.push_back(loss_line(name, loss));
  if (rig.session().recording().is_recording()) lines.push_back(recording_line(rig));
}

}  // namespace

void HealthView::update(const v1::StatusSnapshot& status) {
  if (!seen_.empty() && seen_.back().instance_id() != status.instance_id()) seen_.clear();
  seen_.push_back(status);
  while (seen_.size() > kMostSeen || seen_.back().host_time_ns() - seen_.front().host_time_ns() > kLatencyWindowNs) seen_.pop_front();
}

std::optional<double> HealthView::latency_ms(const v1::RigStatus& rig, double share) const {
  const v1::LatencyHistogram* earlier = nullptr;
  for (const v1::RigStatus& before : seen_.front().rigs()) {
    if (seen_.size() > 1 && before.rig().name() == rig.rig().name()) earlier = &before.latency();
  }
  return latency_quantile_ms(rig.latency(), share, earlier);
}

std::vector<std::string> HealthView::table(std::size_t columns) const {
  std::ostringstream text;
  cli::Console plain{.out = text, .talk = text, .is_out_terminal = true, .columns = columns};
  cli::Table rigs(
      {"RIG", "DEVICE", ">RATE (Hz)", ">LOST", ">GAPS", ">DROPPED", ">QUEUES (%)", ">US/SCAN", ">P50 (ms)", ">P95 (ms)", "SESSION"});
  for (const v1::RigStatus& rig : seen_.back().rigs()) {
    rigs.add({{rig.rig().name()},
              {enumerator_word(*v1::DeviceState_descriptor(), rig.device())},
              {rig.measured_rate_hz() > 0.0 ? cli::decimal(rig.measured_rate_hz(), 2) : "-"},
              {std::to_string(rig.lost_scans_total())},
              {std::to_string(rig.gaps_total())},
              {std::to_string(rig.dropped_blocks_total())},
              {percent_text(rig.ring_fill())},
              {rig.has_pipeline_us_per_scan() ? cli::decimal(rig.pipeline_us_per_scan(), 1) : "-"},
              {milliseconds_text(latency_ms(rig, kMedian))},
              {milliseconds_text(latency_ms(rig, kNearlyAll))},
              {is_shown(rig.session()) ? session_line(rig.session()) : "-"}});
  }
  rigs.may_drop({"US/SCAN", "P50 (ms)", "QUEUES (%)", "DROPPED", "GAPS", "DEVICE", "P95 (ms)"});
  rigs.print(plain);
  std::vector<std::string> lines;
  std::istringstream all(text.str());
  for (std::string line; std::getline(all, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> HealthView::lines(std::size_t columns) const {
  if (seen_.empty()) return {};
  const v1::StatusSnapshot& status = seen_.back();
  std::vector<std::string> lines{"dtsd " + status.version() + ", up " + cli::duration(status.uptime_s())};
  if (status.rigs_size() == 0) lines.emplace_back("no rig is configured");
  for (std::string& line : table(columns)) lines.push_back(std::move(line));
  for (const v1::RigStatus& rig : status.rigs()) add_rig_lines(rig, lines);
  if (const std::string disk = disk_line(status.disk()); !disk.empty()) lines.push_back("disk: " + disk);
  for (const std::string& notice : notice_lines(status)) lines.push_back("notice: " + notice);
  return lines;
}

cli::Json HealthView::rig_json(const v1::RigStatus& rig) const {
  cli::Json out{{"rig", rig.rig().name()}, {"device", enumerator_word(*v1::DeviceState_descriptor(), rig.device())}};
  if (rig.measured_rate_hz() > 0.0) cli::set_number(out, "measured_rate_hz", rig.measured_rate_hz());
  out["scans_total"] = rig.scans_total();
  out["lost_scans_total"] = rig.lost_scans_total();
  out["gaps_total"] = rig.gaps_total();
  out["losses"] = cli::Json::array();
  for (const v1::LossCount& loss : rig.losses()) out["losses"].push_back(to_json(loss));
  out["dropped_blocks_total"] = rig.dropped_blocks_total();
  out["ring_fill"] = to_json(rig.ring_fill());
  if (rig.has_pipeline_us_per_scan()) cli::set_number(out, "pipeline_us_per_scan", rig.pipeline_us_per_scan());
  cli::set_number(out, "latency_p50_ms", latency_ms(rig, kMedian).value_or(std::numeric_limits<double>::quiet_NaN()));
  cli::set_number(out, "latency_p95_ms", latency_ms(rig, kNearlyAll).value_or(std::numeric_limits<double>::quiet_NaN()));
  if (!rig.session().session_id().empty()) {
    out["session_id"] = rig.session().session_id();
    out["session_state"] = enumerator_word(*v1::SessionState_descriptor(), rig.session().state());
  }
  if (rig.session().recording().is_recording()) {
    out["recording_bytes"] = rig.session().recording().bytes();
    cli::set_number(out, "record_lag_s", rig.record_lag_s());
  }
  return out;
}

cli::Json HealthView::json() const {
  if (seen_.empty()) return cli::Json::object();
  const v1::StatusSnapshot& status = seen_.back();
  cli::Json out{{"version", status.version()}, {"host_time_ns", status.host_time_ns()}};
  cli::set_number(out, "uptime_s", status.uptime_s());
  out["rigs"] = cli::Json::array();
  for (const v1::RigStatus& rig : status.rigs()) out["rigs"].push_back(rig_json(rig));
  if (status.has_disk()) out["disk"] = to_json(status.disk());
  return out;
}

}  // namespace dts::ctl
