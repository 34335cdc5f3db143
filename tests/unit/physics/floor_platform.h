// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "physics/cop/cop_estimator.h"
#include "physics/plate/influence_table.h"
#include "physics/rig_model.h"

// The thesis's floor platform, for the tests of this folder.

namespace dts::physics::test {

inline constexpr double kGravity = 9.80665;

inline Point at(double x_mm, double y_mm) { return {{x_mm}, {y_mm}}; }

/// Plate-model section 1, material table.
inline Plate steel_plate() { return {.a = {430.0}, .b = {430.0}, .h = {3.0}, .e_pa = 198.7e9, .nu = 0.27}; }
inline Plate acrylic_plate() { return {.a = {430.0}, .b = {430.0}, .h = {4.0}, .e_pa = 3.5e9, .nu = 0.31}; }

inline Support corners(double inset_mm) { return {.kind = SupportKind::Corner, .inset = {inset_mm}}; }
inline Support edges() { return {.kind = SupportKind::Edges, .inset = {}}; }

/// Plate-model section 3: w1..w4.
inline std::vector<Point> floor_sensors() { return {at(86, 86), at(344, 86), at(86, 344), at(344, 344)}; }

inline RigModel floor_rig(double inset_mm) {
  RigModel rig{.plate = steel_plate(), .support = corners(inset_mm), .sensors = {}};
  const auto positions = floor_sensors();
  for (std::size_t k = 0; k < positions.size(); ++k) {
    rig.sensors.push_back({.label = "w" + std::to_string(k + 1), .position = positions[k], .curve = SensorCurve::hoa1405_assumed()});
  }
  return rig;
}

/// The plate itself rather than its grid: 40 and 80 divisions extrapolated to none (Richardson, second order). The figures of
/// plate-model section 5 are those of the plate; at 40 divisions a load right above a sensor is off by 0.3 mm.
class RefinedPlate {
 public:
  RefinedPlate(const Plate& plate, const Support& support, std::span<const Point> probes)
      : coarse_(*InfluenceTable::create(plate, support, probes, 40)), fine_(*InfluenceTable::create(plate, support, probes, 80)) {}

  [[nodiscard]] double under_point(std::size_t probe, Point load) const {
    return extrapolate(coarse_.at_point_mm_per_n(probe, load), fine_.at_point_mm_per_n(probe, load));
  }
  [[nodiscard]] double under_patch(std::size_t probe, const Patch& patch) const {
    return extrapolate(coarse_.under_patch_mm_per_n(probe, patch), fine_.under_patch_mm_per_n(probe, patch));
  }

 private:
  static double extrapolate(double coarse, double fine) { return fine + (fine - coarse) / 3.0; }

  InfluenceTable coarse_;
  InfluenceTable fine_;
};

/// Deflections of the floor sensors under a point load.
inline CopSample sample_of(const RefinedPlate& plate, Point position, double load_n) {
  CopSample sample{.load_position = position, .load = {load_n}, .deflection_mm = {}};
  for (std::size_t k = 0; k < kFloorSensors; ++k) sample.deflection_mm.push_back(load_n * plate.under_point(k, position));
  return sample;
}
inline CopSample sample_of(const InfluenceTable& plate, Point position, double load_n) {
  CopSample sample{.load_position = position, .load = {load_n}, .deflection_mm = {}};
  for (std::size_t k = 0; k < kFloorSensors; ++k) sample.deflection_mm.push_back(load_n * plate.at_point_mm_per_n(k, position));
  return sample;
}

/// `count` x `count` positions over the square between the sensors.
inline std::vector<Point> sensor_square(int count) {
  constexpr double kFirstMm = 86.0;
  std::vector<Point> points;
  const double step = (344.0 - kFirstMm) / (count - 1);
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) points.push_back(at(kFirstMm + i * step, kFirstMm + j * step));
  }
  return points;
}

/// Thesis 4.4: five points on each mid-line.
inline std::vector<Point> mid_lines() {
  std::vector<Point> points;
  for (const double s : {86.0, 150.5, 215.0, 279.5, 344.0}) {
    points.push_back(at(s, 215));
    points.push_back(at(215, s));
  }
  return points;
}

inline CopEstimate estimate(const CopEstimator& estimator, const std::vector<double>& deflection_mm) {
  return estimator.estimate(deflection_mm);
}

template <class Table>
std::vector<CopSample> samples_at(const Table& plate, const std::vector<Point>& positions, double load_n) {
  std::vector<CopSample> samples;
  for (const Point& position : positions) samples.push_back(sample_of(plate, position, load_n));
  return samples;
}

}  // namespace dts::physics::test
