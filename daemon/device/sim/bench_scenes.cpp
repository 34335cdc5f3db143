// SPDX-License-Identifier: Apache-2.0
#include "device/sim/bench_scenes.h"

#include <string>

namespace dts::device::sim {

core::Result<std::unique_ptr<Scene>> WeightsScene::create(const FloorOptions& options, const physics::RigModel& rig) {
  DTS_TRY_ASSIGN(auto weights, load_weights(options.weights_file, rig.plate));
  std::vector<physics::Patch> patches;
  for (const Weight& weight : weights) patches.push_back({weight.position, {}, {}});
  DTS_TRY_ASSIGN(auto plate, LoadedPlate::create(options, rig, patches));
  return std::unique_ptr<Scene>(new WeightsScene(options, rig, std::move(weights), std::move(plate)));
}

void WeightsScene::evaluate(double time_s, std::span<double> values) noexcept {
  const Placement now = placement_at(times_, weights_.size(), time_s);
  const Weight& weight = weights_[now.index];
  const double load_n = weight.load_n * now.part;
  const auto deflection_mm = plate_.bend(now.index, {&load_n, 1});
  Truth truth;
  if (load_n > 0.0) {
    truth = {(weight.position.x - rig_.plate.a / 2.0).value, (weight.position.y - rig_.plate.b / 2.0).value, load_n};
  }
  sensors_.write_deflected(deflection_mm, truth, values);
}

core::Result<std::unique_ptr<Scene>> GapsScene::create(const FloorOptions& options, const physics::RigModel& rig) {
  for (std::size_t i = 0; i < options.sensors; ++i) {
    const physics::SensorCurve& curve = rig.sensors[i].curve;
    for (const double gap_mm : options.gaps_mm) {
      if (gap_mm >= curve.minimum_gap().value && gap_mm <= curve.maximum_gap().value) continue;
      return core::fail(core::ErrorCode::InvalidArgument, "a gap of " + std::to_string(gap_mm) + " mm is outside the curve of sensor " +
                                                              rig.sensors[i].label + ", " + std::to_string(curve.minimum_gap().value) +
                                                              " .. " + std::to_string(curve.maximum_gap().value) + " mm");
    }
  }
  return std::unique_ptr<Scene>(new GapsScene(options, rig));
}

void GapsScene::evaluate(double time_s, std::span<double> values) noexcept {
  const Placement now = placement_at(times_, gaps_mm_.size(), time_s);
  sensors_.write_gap(gaps_mm_[now.index], now.part, values);
}

}  // namespace dts::device::sim
