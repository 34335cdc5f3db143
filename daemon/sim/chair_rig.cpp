// SPDX-License-Identifier: Apache-2.0
#include "sim/chair_rig.h"

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dts::sim {
namespace {

constexpr core::Millimetres kTareGap{8.5};
constexpr std::array kColumnsMm = {80.0, 140.0, 180.0, 220.0, 260.0, 320.0};

void add_row(physics::RigModel& rig, const physics::SensorCurve& curve, std::span<const double> columns_mm, double y_mm) {
  for (const double x_mm : columns_mm) {
    rig.sensors.push_back({.label = std::to_string(rig.sensors.size() + 1),
                           .position = {core::Millimetres{x_mm}, core::Millimetres{y_mm}},
                           .curve = curve,
                           .unloaded_gap = kTareGap});
  }
}

}  // namespace

physics::SensorCurve cny70_assumed() {
  constexpr double kDarkV = 0.05;
  constexpr double kRangeV = 4.2;
  constexpr double kHalfMm = 2.5;
  constexpr int kPoints = 47;
  std::vector<physics::CurvePoint> points;
  for (int i = 0; i < kPoints; ++i) {
    const double gap_mm = 0.5 + 0.25 * i;
    const double ratio = gap_mm / kHalfMm;
    points.push_back({core::Millimetres{gap_mm}, core::Volts{kDarkV + kRangeV / (1.0 + ratio * ratio)}});
  }
  return *physics::SensorCurve::create("cny70-assumed", std::move(points));
}

physics::RigModel chair_rig() {
  physics::RigModel rig;
  rig.plate = {.a = core::Millimetres{400.0}, .b = core::Millimetres{360.0}, .h = core::Millimetres{6.0}, .e_pa = 3.3e9, .nu = 0.35};
  rig.support = {.kind = physics::SupportKind::Edges};
  const physics::SensorCurve curve = cny70_assumed();  // costs milliseconds: computed once for all sensors
  constexpr std::array kTwoColumnsMm = {kColumnsMm[1], kColumnsMm[4]};
  add_row(rig, curve, kColumnsMm, 120.0);
  add_row(rig, curve, kTwoColumnsMm, 170.0);
  add_row(rig, curve, kColumnsMm, 220.0);
  add_row(rig, curve, kTwoColumnsMm, 290.0);
  rig.transient_sensors = physics::RigModel::TransientSensors{.rear = {1, 4}, .front = {9, 12}};
  return rig;
}

}  // namespace dts::sim
