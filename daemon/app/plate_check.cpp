// SPDX-License-Identifier: Apache-2.0
#include "app/plate_check.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "physics/plate/stiffening_plate.h"
#include "physics/stance.h"

namespace dts::app {
namespace {

constexpr core::Millimetres kFootWidth{100.0};

bool needs_plate_model(const pipeline::RigConfig& rig) {
  return rig.kind == "floor" && !rig.model.force_plate && (!rig.cop_calibration || rig.device_uri.starts_with("sim:"));
}

/// Returns how far the plate's centre bends when a subject stands there on one foot; nothing if the plate is invalid, which is reported
/// when the rig is created.
std::optional<double> deflection_mm(const physics::RigModel& model, const physics::Stance& stance) {
  const std::array centre{physics::Point{model.plate.a * 0.5, model.plate.b * 0.5}};
  const auto plate = physics::StiffeningPlate::create(model.plate, model.support, centre);
  if (!plate) return std::nullopt;
  return std::abs(plate->deflections_mm({.centre = centre[0], .width = kFootWidth, .height = stance.foot_length}, stance.load)[0]);
}

}  // namespace

files::Problems plate_warnings(const DaemonConfig& config) {
  files::Problems warnings;
  const physics::Stance stance;  // the simulator's default person
  for (const ConfiguredRig& configured : config.rigs) {
    if (!needs_plate_model(configured.rig)) continue;
    const double h_mm = configured.rig.model.plate.h.value;
    const auto bends_mm = deflection_mm(configured.rig.model, stance);
    if (!bends_mm || *bends_mm <= physics::StiffeningPlate::kMostThicknesses * h_mm) continue;
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(),
                  "the plate bends by %.1f mm under one foot of a person of %.0f N, more than %.1f times its thickness (%.1f mm)",
                  *bends_mm, stance.load.value, physics::StiffeningPlate::kMostThicknesses, h_mm);
    warnings.push_back(configured.where);
    warnings.back().text = "[[rig]] '" + configured.rig.name + "' (" + configured.rig_file + "): " + text.data() +
                           ": the plate model is not valid there; use a thicker plate, or calibrate a real rig: dtsctl calibrate cop";
  }
  return warnings;
}

}  // namespace dts::app
