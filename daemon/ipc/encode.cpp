// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode.h"

#include <algorithm>
#include <limits>

#include "record/utf8_text.h"
#include "session/session_events.h"

namespace dts::ipc {
namespace {

void set_rate(dts::v1::Rate& out, const core::Rate& rate) {
  out.set_numerator(rate.numerator());
  out.set_denominator(rate.denominator());
}

/// Returns the state of the tare in use: after a rejected tare, the previous one stays in use.
dts::v1::TareState tare_state(const pipeline::TareReport& tare) {
  if (tare.is_older_in_use) return dts::v1::TARE_STATE_DONE;
  switch (tare.outcome) {
    case pipeline::TareOutcome::None: return dts::v1::TARE_STATE_UNSPECIFIED;
    case pipeline::TareOutcome::Running: return dts::v1::TARE_STATE_RUNNING;
    case pipeline::TareOutcome::Done: return dts::v1::TARE_STATE_DONE;
    case pipeline::TareOutcome::Loaded: return dts::v1::TARE_STATE_LOADED;
    case pipeline::TareOutcome::Unsteady: return dts::v1::TARE_STATE_UNSTEADY;
    case pipeline::TareOutcome::BadSensor: return dts::v1::TARE_STATE_BAD_SENSOR;
  }
  return dts::v1::TARE_STATE_UNSPECIFIED;
}

static_assert(static_cast<int>(device::DeviceCheck::Outcome::Skipped) == dts::v1::CHECK_OUTCOME_SKIPPED);
static_assert(static_cast<int>(core::ErrorCode::Internal) == dts::v1::ERROR_CODE_INTERNAL);
static_assert(core::quality::kSubstituted == dts::v1::QUALITY_SUBSTITUTED);
static_assert(core::quality::kUntared == dts::v1::QUALITY_UNTARED && core::quality::kNoContact == dts::v1::QUALITY_NO_CONTACT);

void add_health(const session::RigState& state, dts::v1::RigStatus& out) {
  add_losses(state.acquisition.losses, *out.mutable_losses());
  out.mutable_ring_fill()->set_frames_percent(state.ring_fill.frames_percent);
  out.mutable_ring_fill()->set_record_percent(state.ring_fill.record_percent);
  *out.mutable_latency() = latency_histogram(state.published.latency);
  if (state.recording.is_recording) out.set_record_lag_s(state.recording.lag_s);
}

dts::v1::RigStatus rig_status(const session::RigState& state) {
  dts::v1::RigStatus out;
  *out.mutable_rig() = rig_info(state.rig);
  out.set_device(state.acquisition.is_armed ? dts::v1::DEVICE_STATE_WAITING : session::to_message(state.acquisition.device));
  const std::string_view device_message = state.acquisition.text();
  out.set_device_message(record::clean_text(device_message.empty() ? state.sensor_problems : device_message));
  out.set_segment(state.acquisition.segment);
  out.set_scans_total(state.acquisition.scans_total);
  out.set_lost_scans_total(state.acquisition.losses.total().scans);
  out.set_gaps_total(state.acquisition.losses.total().gaps);
  out.set_reconnects_total(state.acquisition.reconnects_total);
  out.set_dropped_blocks_total(state.published.lost_frames);
  out.set_nominal_rate_hz(state.acquisition.rate.hz());
  if (state.measured_rate_hz > 0.0) out.set_measured_rate_hz(state.measured_rate_hz);
  out.set_lost_events_total(state.published.lost_events);
  if (state.pipeline.us_per_scan > 0.0) out.set_pipeline_us_per_scan(state.pipeline.us_per_scan);
  out.set_restarts_total(state.acquisition.restarts_total);
  if (state.acquisition.clock_drift_ppm != 0.0) out.set_clock_drift_ppm(state.acquisition.clock_drift_ppm);
  out.set_host_time_uncertainty_ns(state.acquisition.host_time_uncertainty_ns);
  out.set_tare(tare_state(state.tare));
  if (state.tare.drift_n_per_min) out.set_zero_drift_n_per_min(*state.tare.drift_n_per_min);
  add_health(state, out);
  *out.mutable_session() = session_info(state.rig.config().name, state.session);
  *out.mutable_session()->mutable_recording() = recording_status(state.recording, state.part);
  if (state.trial) *out.mutable_session()->mutable_trial() = trial_status(*state.trial);
  return out;
}

}  // namespace

StreamEncoder::StreamEncoder(std::uint64_t instance_id, const std::string& rig, const core::StreamFormat& format)
    : topic_(rig + "/" + format.name) {
  message_.set_instance_id(instance_id);
  message_.set_channel_count(static_cast<std::uint32_t>(format.channels.size()));
  set_rate(*message_.mutable_rate(), format.rate);
}

const dts::v1::StreamBlock& StreamEncoder::encode(const core::Block& block, std::uint64_t lost_scans_total,
                                                  std::uint64_t dropped_blocks_total) {
  const std::size_t scans = block.count();
  const std::size_t channels = block.channel_count();
  message_.set_segment(block.segment);
  message_.set_first_scan(block.first_scan.value);
  message_.set_scan_count(static_cast<std::uint32_t>(scans));
  message_.set_host_time_ns(block.host_time_ns);
  message_.set_host_time_uncertainty_ns(block.host_time_uncertainty_ns);
  message_.set_sequence(block.sequence);
  message_.set_lost_scans_total(lost_scans_total);
  message_.set_dropped_blocks_total(dropped_blocks_total);
  message_.mutable_values()->Resize(static_cast<int>(scans * channels), 0.0F);
  float* values = message_.mutable_values()->mutable_data();
  std::string& quality = *message_.mutable_quality();
  quality.assign(channels, '\0');
  for (std::size_t channel = 0; channel < channels; ++channel) {
    // float32 has 24 significant bits, more than any DAQ here: 0.03 um at 430 mm.
    values = std::ranges::transform(block.column(channel), values, [](double value) { return static_cast<float>(value); }).out;
    std::uint8_t bits = 0;
    for (const std::uint8_t of_scan : block.quality(channel)) bits |= of_scan;
    quality[channel] = static_cast<char>(bits);
  }
  return message_;
}

dts::v1::StatusSnapshot status_snapshot(const Identity& identity, const core::Clock& clock, const std::vector<session::RigState>& states,
                                        const std::vector<std::string>& notices) {
  const std::int64_t now_ns = clock.now_ns();
  dts::v1::StatusSnapshot out;
  out.set_instance_id(identity.instance_id);
  out.set_version(identity.version);
  out.set_uptime_s(static_cast<double>(now_ns - identity.started_ns) * 1e-9);
  out.set_host_time_ns(now_ns);
  out.set_utc_minus_monotonic_ns(clock.utc_minus_monotonic_ns());
  out.set_boot_id(identity.boot_id);
  for (const std::string& notice : notices) out.add_notices(notice);
  for (const session::RigState& state : states) *out.add_rigs() = rig_status(state);
  return out;
}

dts::v1::LatencyHistogram latency_histogram(const session::LatencyReport& report) {
  dts::v1::LatencyHistogram out;
  std::uint64_t total = 0;
  for (std::size_t index = 0; index < report.blocks.size(); ++index) {
    auto& bucket = *out.add_buckets();
    const bool is_last = index == session::LatencyReport::kUpperMs.size();
    bucket.set_upper_ms(is_last ? std::numeric_limits<double>::infinity() : session::LatencyReport::kUpperMs[index]);
    bucket.set_blocks_total(total += report.blocks[index]);
  }
  out.set_sum_ms(report.sum_ms);
  return out;
}

dts::v1::RigInfo rig_info(const session::Rig& rig) {
  dts::v1::RigInfo out;
  const pipeline::RigConfig& config = rig.config();
  out.set_name(config.name);
  out.set_kind(config.kind);
  out.set_device_uri(config.device_uri);
  out.set_plate_a_mm(config.model.plate.a.value);
  out.set_plate_b_mm(config.model.plate.b.value);
  out.set_is_force_plate(config.model.force_plate.has_value());
  if (!config.model.force_plate) out.set_plate_h_mm(config.model.plate.h.value);
  for (std::size_t index = 0; index < config.model.sensors.size(); ++index) {
    const physics::SensorModel& sensor = config.model.sensors[index];
    auto& info = *out.add_sensors();
    info.set_label(sensor.label);
    info.set_x_mm(sensor.position.x.value);
    info.set_y_mm(sensor.position.y.value);
    const auto& channel = rig.device().channels[config.sensor_channels[index]];
    info.set_channel(channel.name);
    info.set_range_low_v(channel.minimum);
    info.set_range_high_v(channel.maximum);
    info.set_curve(sensor.curve.name());
    info.set_unloaded_gap_mm(sensor.unloaded_gap.value);
  }
  for (const core::StreamFormat& format : rig.formats()) {
    auto& stream = *out.add_streams();
    stream.set_name(format.name);
    set_rate(*stream.mutable_rate(), format.rate);
    stream.set_delay_ns(format.delay_ns);
    for (const core::ChannelFormat& channel : format.channels) {
      auto& described = *stream.add_channels();
      described.set_name(channel.name);
      described.set_unit(channel.unit);
    }
  }
  for (const std::string& stage : rig.stage_texts()) out.add_stages(stage);
  for (const std::string& stream : config.published) out.add_published(stream);
  if (config.cop_calibration) out.set_calibration(config.cop_calibration->id);
  return out;
}

dts::v1::Error error_message(const core::Error& error) {
  dts::v1::Error out;
  out.set_code(static_cast<dts::v1::ErrorCode>(error.code));  // same numbers, asserted above
  out.set_what(error.what);
  out.set_hint(error.hint);
  return out;
}

}  // namespace dts::ipc
