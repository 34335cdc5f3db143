// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/transient.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "core/special_numbers.h"
#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
constexpr double kMostMm = 1e6;
constexpr double kRestS = 1.0;  ///< Time constant of a channel's rest level.

/// Channel of the same row, on the other side.
constexpr std::size_t partner(std::size_t channel) noexcept { return channel ^ 1U; }

/// Returns the number of equal codes in a row that chance does not explain. Two readings of a channel with noise of `noise_v` rms agree
/// with probability q / (2 sqrt(pi) noise) for codes of width q; a chance below 1e-9 per scan is a fault. 16 bit of +-5 V and 3 mV: 5, as
/// in reach-model section 5; 12 bit: 15. Returns 0 if the noise is too small to detect a fault in this way.
std::uint64_t still_scans(double resolution_v, double noise_v) {
  if (noise_v <= 0.0) return 0;
  const double chance = resolution_v / (2.0 * std::sqrt(std::numbers::pi) * noise_v);
  if (chance > 0.9) return 0;
  return std::max<std::uint64_t>(5, static_cast<std::uint64_t>(std::ceil(std::log(1e-9) / std::log(std::max(chance, 1e-9)))));
}

/// Returns the rig's own choice; otherwise, of four sensors, the two with the smaller y as the rear pair. Each pair is ordered from left to
/// right.
std::optional<physics::RigModel::TransientSensors> choose_sensors(const physics::RigModel& rig) {
  if (rig.transient_sensors) return rig.transient_sensors;
  if (rig.sensors.size() != Transient::kSensors) return std::nullopt;
  std::array<std::size_t, Transient::kSensors> order{};
  std::iota(order.begin(), order.end(), 0U);
  const auto y = [&](std::size_t sensor) { return rig.sensors[sensor].position.y.value; };
  const auto x = [&](std::size_t sensor) { return rig.sensors[sensor].position.x.value; };
  std::ranges::stable_sort(order, {}, y);
  std::ranges::stable_sort(std::span(order).first(2), {}, x);
  std::ranges::stable_sort(std::span(order).last(2), {}, x);
  return physics::RigModel::TransientSensors{.rear = {order[0], order[1]}, .front = {order[2], order[3]}};
}

}  // namespace

Transient::Transient(const StageOptions& options, const StageContext& context)
    : rig_(&context.rig), resolution_v_(0.0), noise_mv_(options.number("noise_mv")) {
  for (const StageContext::InputRange& range : context.input_ranges) resolution_v_ = std::max(resolution_v_, range.resolution_v);
}

const StageDescription& Transient::description() {
  static const StageDescription described{
      .id = "transient",
      .sentence = "How far a chair's seat bends, and where: mean, front to rear and twist of four sensors, bad ones replaced.",
      .output_stream = "transient",
      .options = {
          {.name = "noise_mv",
           .sentence = "Noise of a sensor, rms. A sensor that is constant for longer than this noise allows is bad; 0: not checked.",
           .default_value = 3.0,
           .minimum = 0.0,
           .maximum = 100.0}}};
  return described;
}

core::Result<core::StreamFormat> Transient::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("transient", input, max_scans, "mm"));
  const auto chosen = choose_sensors(*rig_);
  if (!chosen) {
    return core::fail(
        core::ErrorCode::InvalidArgument,
        "stage transient: the rig has " + std::to_string(rig_->sensors.size()) + " sensors, but does not name the four to use",
        "name two rear and two front sensors in the rig's file");
  }
  columns_ = {chosen->rear[0], chosen->rear[1], chosen->front[0], chosen->front[1]};
  auto sorted = columns_;
  std::ranges::sort(sorted);
  if (sorted.back() >= input.channels.size()) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage transient: the rig names sensor " + std::to_string(sorted.back() + 1) +
                                                            ", but only " + std::to_string(input.channels.size()) + " channels arrive");
  }
  if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end()) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage transient: the rig names sensor " + std::to_string(*twice + 1) + " twice");
  }
  still_limit_ = still_scans(resolution_v_, noise_mv_ / 1000.0);
  if (still_limit_ > 0) still_limit_ = std::max(still_limit_, input.rate.scans_in_ms(50.0)) - 1;  // the noise of real sensors is not white
  rest_gain_ = 1.0 - std::exp(-1.0 / (kRestS * input.rate.hz()));
  reset();
  core::StreamFormat output = input;
  output.channels = {{.name = "transient_mm", .unit = "mm"}, {.name = "ratio", .unit = "1"}, {.name = "twist", .unit = "1"}};
  return output;
}

bool Transient::is_believed(Channel& channel, double value_mm, std::uint8_t bits) const noexcept {
  channel.repeats = value_mm == channel.last_mm ? channel.repeats + 1 : 0;
  channel.last_mm = std::isfinite(value_mm) ? value_mm : kNaN;
  if ((bits & kFaultBits) != 0 || !(std::abs(value_mm) < kMostMm)) return false;
  return still_limit_ == 0 || channel.repeats < still_limit_;
}

std::uint8_t Transient::look(const core::Block& in, std::size_t scan, Values& values, Goods& goods) noexcept {
  std::uint8_t faults = 0;
  for (std::size_t k = 0; k < kSensors; ++k) {
    Channel& channel = channels_[k];
    const double value_mm = in.column(columns_[k])[scan];
    const std::uint8_t bits = in.quality(columns_[k])[scan];
    goods[k] = is_believed(channel, value_mm, bits);
    if (goods[k]) {
      values[k] = channel.spikes.filter(value_mm);
      faults |= static_cast<std::uint8_t>(bits & core::quality::kUntared);
      continue;
    }
    channel.spikes.reset();
    const std::uint8_t reason = std::isfinite(value_mm) && (bits & kFaultBits) == 0 ? core::quality::kStuck : 0;
    faults |= explained(value_mm, static_cast<std::uint8_t>(bits | reason));
  }
  return faults;
}

void Transient::follow_rest(const Values& values, const Goods& goods) noexcept {
  for (std::size_t k = 0; k < kSensors; ++k) {
    if (channels_[k].was_good && !goods[k]) return;  // the rest levels of all channels must be of the same time
  }
  for (std::size_t k = 0; k < kSensors; ++k) {
    Channel& channel = channels_[k];
    if (!goods[k]) continue;
    channel.rest_mm = channel.was_good ? channel.rest_mm + rest_gain_ * (values[k] - channel.rest_mm) : values[k];
    channel.was_good = true;
  }
}

bool Transient::substitute(Values& values, const Goods& goods) const noexcept {
  double change_mm = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < kSensors; ++k) {
    if (!goods[k]) continue;
    change_mm += values[k] - channels_[k].rest_mm;
    ++count;
  }
  if (count < 2) return false;
  for (std::size_t k = 0; k < kSensors; ++k) {
    if (goods[k]) continue;
    const Channel& channel = channels_[k];
    const std::size_t other = partner(k);
    if (goods[other]) {
      values[k] = values[other] + (channel.was_good ? channel.rest_mm - channels_[other].rest_mm : 0.0);
    } else if (channel.was_good) {
      values[k] = channel.rest_mm + change_mm / count;
    } else {
      return false;
    }
  }
  return true;
}

void Transient::process(const core::Block& in, core::Block& out) noexcept {
  for (std::size_t i = 0; i < in.count(); ++i) {
    Values values{};
    Goods goods{};
    std::uint8_t bits = look(in, i, values, goods);
    follow_rest(values, goods);
    const bool is_whole = std::ranges::find(goods, false) == goods.end();
    std::array<double, 3> result{kNaN, kNaN, kNaN};
    if (is_whole || substitute(values, goods)) {
      const double mean_mm = (values[0] + values[1] + values[2] + values[3]) / 4.0;
      const double divisor_mm = std::max(mean_mm, kEmptyMm);  // values stay finite on an empty seat
      result = {mean_mm, (values[2] + values[3] - values[0] - values[1]) / 2.0 / divisor_mm,
                ((values[0] - values[1]) - (values[2] - values[3])) / divisor_mm};
      const bool is_at_end = (bits & (core::quality::kRail | core::quality::kOutOfRange)) != 0;
      const int doubts = (is_whole ? 0 : core::quality::kSubstituted) | (is_at_end ? core::quality::kUncalibrated : 0) |
                         (mean_mm < kEmptyMm ? core::quality::kNoContact : 0);
      bits = static_cast<std::uint8_t>((bits & ~kFaultBits) | doubts);
    }
    for (std::size_t c = 0; c < result.size(); ++c) {
      out.column(c)[i] = result[c];
      out.quality(c)[i] = bits;
    }
  }
}

void Transient::reset() noexcept { channels_ = {}; }

std::size_t Transient::state_size() const noexcept { return kSensors * (SpikeFilter::kStateSize + 4); }

void Transient::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  for (const Channel& channel : channels_) {
    channel.spikes.save(writer);
    writer.put(channel.last_mm);
    writer.put_count(channel.repeats);
    writer.put(channel.rest_mm);
    writer.put(channel.was_good ? 1.0 : 0.0);
  }
}

bool Transient::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  for (Channel& channel : channels_) {
    channel.spikes.restore(reader);
    const double last_mm = reader.any();
    channel.last_mm = std::isfinite(last_mm) ? last_mm : kNaN;
    channel.repeats = reader.count(std::numeric_limits<std::uint64_t>::max());
    channel.rest_mm = reader.number(-kMostMm, kMostMm);
    channel.was_good = reader.flag();
  }
  if (!reader.is_right()) reset();
  return reader.is_right();
}

}  // namespace dts::pipeline
