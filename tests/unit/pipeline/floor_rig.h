// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "physics/cop/cop_calibration.h"
#include "physics/cop/sensed_plate.h"
#include "physics/rig_model.h"
#include "pipeline/stage_registry.h"
#include "unit/classifier/hand_made_model.h"

namespace dts::pipeline {

/// The thesis's floor platform (plate-model sections 1, 3 and 5): steel, supports 10.75 mm inside the corners, sensors at 86 and 344 mm.
inline physics::RigModel floor_rig() {
  physics::RigModel rig{.plate = {}, .support = {.kind = physics::SupportKind::Corner, .inset = {10.75}}, .sensors = {}};
  for (const auto& [label, x, y] : {std::tuple{"w1", 86.0, 86.0}, {"w2", 344.0, 86.0}, {"w3", 86.0, 344.0}, {"w4", 344.0, 344.0}}) {
    rig.sensors.push_back({.label = label, .position = {{x}, {y}}, .curve = physics::SensorCurve::hoa1405_assumed()});
  }
  return rig;
}

/// Deflections of the floor platform under point loads, plate coordinates; by default on the stiffening plate that the estimators know.
class FloorPlate {
 public:
  explicit FloorPlate(const physics::RigModel& rig, physics::PlateBehaviour behaviour = physics::PlateBehaviour::Stiffening)
      : plate_(physics::SensedPlate::create(rig, behaviour).value()) {}

  [[nodiscard]] std::vector<double> deflection_mm(physics::Point position, double load_n) const {
    return plate_.deflection_mm(position, {load_n});
  }

 private:
  physics::SensedPlate plate_;
};

/// What stages hang on: a rig, a letter box and converters of +-5 V with 11 bit (thesis 4.3.2).
struct StageSurroundings {
  explicit StageSurroundings(physics::RigModel model = floor_rig()) : rig(std::move(model)) {}

  [[nodiscard]] StageContext context() {
    constexpr StageContext::InputRange kConverter{.minimum_v = -5.0, .maximum_v = 5.0, .resolution_v = 10.0 / 2048.0};
    return {.rig = rig,
            .input_ranges = std::vector(rig.sensors.size(), kConverter),
            .tare = tare,
            .windows = windows,
            .cop_calibration = cop_calibration ? &*cop_calibration : nullptr,
            .trunk_model = trunk_model ? &*trunk_model : nullptr};
  }
  [[nodiscard]] std::unique_ptr<Stage> make(const StageConfig& config) { return create_stage(config, context()).value(); }

  physics::RigModel rig;
  Tare tare;
  SteadinessWindows windows;
  std::optional<physics::CopCalibration> cop_calibration;
  std::optional<classifier::TrunkModel> trunk_model = classifier::TrunkModel::create(classifier::hand_made_form()).value();
};

}  // namespace dts::pipeline
