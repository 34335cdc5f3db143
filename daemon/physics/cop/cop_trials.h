// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/cop/cop_form.h"
#include "physics/plate/solve.h"
#include "physics/rig_model.h"

// Loads on a plate, to calibrate an estimator or to measure its error.

namespace dts::physics {

/// One load case: the forces and their centre.
struct CopTrial {
  Point centre;
  std::vector<PlateLoad> loads;
};

/// Returns the centre of pressure of the loads; they must not be empty.
[[nodiscard]] Point centre_of(std::span<const PlateLoad> loads);

/// The rectangle between the four sensors of a floor platform, or around all sensors of another rig. Sides are averages, because the sides
/// of the sensor square need not be exactly parallel to the plate's. The rig must have at least one sensor.
struct SensorRectangle {
  core::Millimetres left, right, bottom, top;

  [[nodiscard]] static SensorRectangle of(const RigModel& rig);
  [[nodiscard]] Point centre() const noexcept { return {(left + right) / 2, (bottom + top) / 2}; }
};

/// Returns the positions P1..P15 of thesis Table 4.1: a triangular eighth of the square between the sensors.
[[nodiscard]] std::vector<Point> table_41_positions();
/// Returns five evenly spaced points on each mid-line of the rectangle, first along x, then along y (thesis 4.4).
[[nodiscard]] std::vector<Point> mid_line_positions(const SensorRectangle& area);
/// Returns `count` x `count` positions over the rectangle, row by row from its bottom left corner; `count` must be at least 2.
[[nodiscard]] std::vector<Point> grid_positions(const SensorRectangle& area, std::size_t count);

/// Returns a point load at every position with every load, load by load.
[[nodiscard]] std::vector<CopTrial> point_trials(std::span<const Point> positions, std::span<const double> loads_n);
/// Returns `count` random stances on `feet` (1 or 2) feet, with heel and forefoot patches as `place_stance` places them, random shares of
/// the weight, and loads uniform in `load_n`. The same seed gives the same stances. Returns fewer than `count` if the plate is too small
/// for most stances.
[[nodiscard]] std::vector<CopTrial> foot_trials(const Plate& plate, std::size_t feet, std::size_t count, Interval load_n,
                                                std::uint64_t seed);

}  // namespace dts::physics
