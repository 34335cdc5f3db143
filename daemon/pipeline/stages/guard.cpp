// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/guard.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/special_numbers.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
constexpr std::uint64_t kMinimumStuckScans = 50;  // at 10 Hz, 1 s of equal codes may be chance

}  // namespace

Guard::Guard(const StageOptions& options, const StageContext& context)
    : ranges_(context.input_ranges),
      rail_codes_(options.number("rail_codes")),
      stuck_ms_(options.number("stuck_ms")),
      marker_channel_(static_cast<int>(options.number("marker_channel"))),
      marker_v_(options.number("marker_v")),
      marker_tolerance_v_(options.number("marker_tolerance_v")) {}

const StageDescription& Guard::description() {
  static const StageDescription described{
      .id = "guard",
      .sentence = "Marks values at the converter's end, stuck channels and rotated scans.",
      .output_stream = "raw",
      .options = {
          {.name = "rail_codes",
           .sentence = "Codes next to the ends of the converter's range that count as rail.",
           .default_value = 1.0,
           .minimum = 0.0,
           .maximum = 1000.0,
           .is_whole = true},
          {.name = "stuck_ms",
           .sentence = "A value that stays the same for longer (and for 50 scans) is stuck; 0: never.",
           .default_value = 1000.0,
           .minimum = 0.0,
           .maximum = 3'600'000.0},
          {.name = "marker_channel",
           .sentence = "Auxiliary channel, counted from 0, wired to a known voltage to detect rotated scans; -1: none.",
           .default_value = -1.0,
           .minimum = -1.0,
           .maximum = static_cast<double>(core::kMaxChannels - 1),
           .is_whole = true},
          {.name = "marker_v", .sentence = "Voltage of the marker channel.", .default_value = 0.0, .minimum = -10.0, .maximum = 10.0},
          {.name = "marker_tolerance_v",
           .sentence = "How far the marker may be off before the scan is marked.",
           .default_value = 0.1,
           .minimum = 0.0,
           .maximum = 10.0}}};
  return described;
}

core::Result<core::StreamFormat> Guard::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("guard", input, max_scans, ""));
  const std::size_t channels = input.channels.size();
  if (ranges_.empty() || ranges_.size() > channels) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage guard: " + std::to_string(ranges_.size()) + " sensors have a range, but " +
                                                            std::to_string(channels) + " channels arrive");
  }
  const std::size_t aux_channels = channels - ranges_.size();
  if (marker_channel_ >= static_cast<int>(aux_channels)) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "stage guard: option 'marker_channel' is " + std::to_string(marker_channel_) + ", but the device has " +
                          std::to_string(aux_channels) + " channels beside the sensors",
                      "use -1 when no marker is wired");
  }
  core::StreamFormat output = input;
  output.channels.resize(ranges_.size());
  DTS_TRY(check_input("guard", output, max_scans, "V"));

  sensors_.clear();
  for (const StageContext::InputRange& range : ranges_) {
    // Half a code more: the voltage of a code is the result of a multiplication and may be off by a rounding error.
    const double margin_v = (rail_codes_ + 0.5) * range.resolution_v;
    sensors_.push_back({.low_rail_v = range.minimum_v + margin_v, .high_rail_v = range.maximum_v - margin_v});
  }
  stuck_limit_ =
      stuck_ms_ > 0.0 ? std::max(kMinimumStuckScans, input.rate.scans_in_ms(stuck_ms_)) : std::numeric_limits<std::uint64_t>::max();
  return output;
}

void Guard::process(const core::Block& in, core::Block& out) noexcept {
  for (std::size_t c = 0; c < sensors_.size(); ++c) mark_sensor(c, in, out);
  if (marker_channel_ >= 0) mark_rotation(in.column(sensors_.size() + static_cast<std::size_t>(marker_channel_)), out);
}

void Guard::mark_sensor(std::size_t index, const core::Block& in, core::Block& out) noexcept {
  const auto volts_in = in.column(index);
  const auto bits_in = in.quality(index);
  const auto volts_out = out.column(index);
  const auto bits_out = out.quality(index);
  Sensor sensor = sensors_[index];  // a local copy: otherwise the compiler must assume that the columns overlap the member
  for (std::size_t i = 0; i < volts_in.size(); ++i) {
    const double volts = volts_in[i];
    sensor.repeats = volts == sensor.last_v ? sensor.repeats + 1 : 0;
    sensor.last_v = volts;
    const bool is_rail = volts <= sensor.low_rail_v || volts >= sensor.high_rail_v;
    const bool is_stuck = sensor.repeats > stuck_limit_;
    const int doubts = (is_rail ? core::quality::kRail : 0) | (is_stuck ? core::quality::kStuck : 0);
    const bool is_number = std::isfinite(volts);
    volts_out[i] = is_number ? volts : kNaN;
    bits_out[i] = static_cast<std::uint8_t>(bits_in[i] | (is_number ? doubts : core::quality::kOutOfRange));
  }
  sensors_[index] = sensor;
}

void Guard::mark_rotation(std::span<const double> marker, core::Block& out) const noexcept {
  for (std::size_t i = 0; i < marker.size(); ++i) {
    if (std::abs(marker[i] - marker_v_) <= marker_tolerance_v_) continue;  // false for NaN
    for (std::size_t c = 0; c < sensors_.size(); ++c) out.quality(c)[i] |= core::quality::kRotation;
  }
}

void Guard::reset() noexcept {
  for (Sensor& sensor : sensors_) sensor.last_v = kNaN;  // NaN equals no value, so the count of repeats restarts
}

std::size_t Guard::state_size() const noexcept { return 2 * sensors_.size(); }

void Guard::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  for (const Sensor& sensor : sensors_) {
    const bool is_number = std::isfinite(sensor.last_v);  // the recorded stream has NaN for every other value, and so will its replay
    writer.put(is_number ? sensor.last_v : kNaN);
    writer.put_count(is_number ? sensor.repeats : 0);
  }
}

bool Guard::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  for (Sensor& sensor : sensors_) {
    const double last_v = reader.any();
    sensor.last_v = std::isfinite(last_v) ? last_v : kNaN;
    sensor.repeats = reader.count(std::numeric_limits<std::uint64_t>::max());
  }
  if (!reader.is_right()) reset();
  return reader.is_right();
}

}  // namespace dts::pipeline
