// SPDX-License-Identifier: Apache-2.0
#include "device/sim/sensor_bank.h"

#include "device/sim/mounting.h"

namespace dts::device::sim {
namespace {

constexpr double kExtraChannelV = 1.0;  // about the voltage of a sensor without load

}  // namespace

SensorBank::SensorBank(const FloorOptions& options, const physics::RigModel& rig) : extra_(options.extra), has_truth_(options.has_truth) {
  const dts::sim::CounterRandom mounting = mounting_random(options.seed);
  for (std::size_t i = 0; i < options.sensors; ++i) {
    sensors_.push_back({.curve = &rig.sensors[i].curve,
                        .unloaded_gap_mm = rig.sensors[i].unloaded_gap.value + options.gap_spread_mm * either_side(mounting, 2 * i + 1),
                        .gain = 1.0 + options.gain_spread * either_side(mounting, 2 * i)});
  }
}

void SensorBank::write_deflected(std::span<const double> deflection_mm, const Truth& truth, std::span<double> values) const noexcept {
  for (std::size_t i = 0; i < sensors_.size(); ++i) values[i] = sensors_[i].volts(sensors_[i].unloaded_gap_mm - deflection_mm[i]);
  write_rest(truth, values);
}

void SensorBank::write_gap(double gap_mm, double part, std::span<double> values) const noexcept {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const double far_mm = sensors_[i].curve->maximum_gap().value;
    values[i] = sensors_[i].volts(far_mm + part * (gap_mm - far_mm));
  }
  write_rest({}, values);
}

void SensorBank::write_rest(const Truth& truth, std::span<double> values) const noexcept {
  std::size_t next = sensors_.size();
  for (std::size_t i = 0; i < extra_; ++i) values[next++] = kExtraChannelV;
  if (!has_truth_) return;
  values[next++] = truth.ml_mm;
  values[next++] = truth.ap_mm;
  values[next] = truth.load_n;
}

}  // namespace dts::device::sim
