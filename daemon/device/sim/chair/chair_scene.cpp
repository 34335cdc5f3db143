// SPDX-License-Identifier: Apache-2.0
#include "device/sim/chair/chair_scene.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "device/sim/mounting.h"

namespace dts::device::sim {
namespace {

constexpr double kSecondsPerHour = 3600.0;
constexpr double kPercent = 0.01;
constexpr double kBeyondAnyRangeV = 100.0;

}  // namespace

core::Result<std::unique_ptr<Scene>> ChairScene::create(const ChairOptions& options, const physics::RigModel& rig) {
  std::vector<physics::Point> probes;
  for (std::size_t i = 0; i < options.sensors; ++i) probes.push_back(rig.sensors[i].position);
  DTS_TRY_ASSIGN(auto plate, dts::sim::SeatPlate::create(rig.plate, rig.support, probes, options.person.habits.contact));
  return std::unique_ptr<Scene>(new ChairScene(options, rig, std::move(plate)));
}

ChairScene::ChairScene(const ChairOptions& options, const physics::RigModel& rig, dts::sim::SeatPlate plate)
    : options_(options), depth_mm_(rig.plate.b.value), plate_(std::move(plate)), deflection_mm_(options.sensors), emg_(options.seed) {
  const dts::sim::CounterRandom mounting = mounting_random(options.seed);
  for (std::size_t i = 0; i < options.sensors; ++i) {
    sensors_.push_back({.curve = &rig.sensors[i].curve,
                        .unloaded_gap_mm = rig.sensors[i].unloaded_gap.value + options.gap_spread_mm * either_side(mounting, 3 * i),
                        .gain = 1.0 + options.gain_spread * either_side(mounting, 3 * i + 1),
                        .drift_per_s = options.drift_percent_per_h * kPercent / kSecondsPerHour * either_side(mounting, 3 * i + 2)});
  }
}

void ChairScene::hear(double time_s, const Cue& cue) noexcept {
  if (person_) person_->hear(time_s, cue.is_go, cue.target_cm);
}

void ChairScene::write_sensors(double time_s, std::span<double> values) const noexcept {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const Sensor& sensor = sensors_[i];
    const double volts = sensor.curve->volts(core::Millimetres{sensor.unloaded_gap_mm - deflection_mm_[i]}).value;
    values[i] = volts * sensor.gain * (1.0 + sensor.drift_per_s * time_s);
  }
  break_sensors(time_s, values);
}

void ChairScene::break_sensors(double time_s, std::span<double> values) const noexcept {
  const SensorFaults& faults = options_.sensor_faults;
  if (time_s >= faults.from_s) {
    for (const std::size_t channel : faults.dead) values[channel] = 0.0;
    for (const std::size_t channel : faults.saturated) values[channel] = kBeyondAnyRangeV;
  }
  if (faults.swapped) std::swap(values[faults.swapped->first], values[faults.swapped->second]);
}

void ChairScene::evaluate(double time_s, std::span<double> values) noexcept {
  if (!person_) person_.emplace(options_.person);
  const dts::sim::SeatedState state = person_->at(time_s);
  if (state.is_there) {
    plate_.deflect(state.load, deflection_mm_);
  } else {
    std::ranges::fill(deflection_mm_, 0.0);
  }
  write_sensors(time_s, values);
  std::size_t next = sensors_.size();
  if (options_.has_emg) {
    emg_.write(time_s, state.is_there, state.reach, values.subspan(next, kEmgChannels));
    next += kEmgChannels;
  }
  if (!options_.has_truth) return;
  constexpr double kNobody = std::numeric_limits<double>::quiet_NaN();
  const double y_mm = state.load.is_uniform ? depth_mm_ / 2.0 : std::clamp(state.load.y_mm, 0.0, depth_mm_);
  values[next++] = state.is_there ? state.trunk_deg : kNobody;
  values[next++] = state.is_there ? y_mm : kNobody;
  values[next] = state.is_there ? state.load.force_n : 0.0;
}

}  // namespace dts::device::sim
