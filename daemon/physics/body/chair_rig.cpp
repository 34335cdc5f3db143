// SPDX-License-Identifier: Apache-2.0
#include "physics/body/chair_rig.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace dts::physics {
namespace {

constexpr core::Millimetres kTareGap{8.5};
constexpr std::array kColumnsMm = {80.0, 140.0, 180.0, 220.0, 260.0, 320.0};

void add_sensor(RigModel& rig, double x_mm, double y_mm) {
  rig.sensors.push_back({.label = std::to_string(rig.sensors.size() + 1),
                         .position = {core::Millimetres{x_mm}, core::Millimetres{y_mm}},
                         .curve = cny70_assumed(),
                         .unloaded_gap = kTareGap});
}

void add_row_of_six(RigModel& rig, double y_mm) {
  for (const double x_mm : kColumnsMm) add_sensor(rig, x_mm, y_mm);
}

void add_row_of_two(RigModel& rig, double y_mm) {
  for (const double x_mm : {kColumnsMm[1], kColumnsMm[4]}) add_sensor(rig, x_mm, y_mm);
}

}  // namespace

SensorCurve cny70_assumed() {
  constexpr double kDarkV = 0.05;
  constexpr double kRangeV = 4.2;
  constexpr double kHalfMm = 2.5;
  constexpr int kPoints = 47;
  std::vector<CurvePoint> points;
  for (int i = 0; i < kPoints; ++i) {
    const double gap_mm = 0.5 + 0.25 * i;
    const double ratio = gap_mm / kHalfMm;
    points.push_back({core::Millimetres{gap_mm}, core::Volts{kDarkV + kRangeV / (1.0 + ratio * ratio)}});
  }
  return *SensorCurve::create("cny70-assumed", std::move(points));
}

RigModel chair_rig() {
  RigModel rig;
  rig.plate = {.a = core::Millimetres{400.0}, .b = core::Millimetres{360.0}, .h = core::Millimetres{6.0}, .e_pa = 3.3e9, .nu = 0.35};
  rig.support = {.kind = SupportKind::Edges};
  add_row_of_six(rig, 120.0);
  add_row_of_two(rig, 170.0);
  add_row_of_six(rig, 220.0);
  add_row_of_two(rig, 290.0);
  rig.transient_sensors = RigModel::TransientSensors{.rear = {1, 4}, .front = {9, 12}};
  return rig;
}

}  // namespace dts::physics
