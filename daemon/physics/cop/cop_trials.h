// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/cop/cop_form.h"
#include "physics/plate/solve.h"
#include "physics/rig_model.h"

// Where loads are put on a plate, to calibrate an estimator or to see what it is worth.

namespace dts::physics {

/// One load to try: forces, and where their centre is.
struct CopTrial {
  Point centre;
  std::vector<PlateLoad> loads;
};

/// The rectangle between the four sensors of a floor platform, or around all sensors of another rig; sides are averages, as the
/// sensors' need not be exactly parallel to the plate's. The rig has at least one sensor.
struct SensorRectangle {
  core::Millimetres left, right, bottom, top;

  [[nodiscard]] static SensorRectangle of(const RigModel& rig);
  [[nodiscard]] Point centre() const noexcept { return {(left + right) / 2, (bottom + top) / 2}; }
};

/// Thesis Table 4.1: the positions P1..P15, a triangular eighth of the square between the sensors.
[[nodiscard]] std::vector<Point> table_41_positions();
/// Thesis 4.4: five evenly spaced points on each mid-line of the rectangle, first along x, then along y.
[[nodiscard]] std::vector<Point> mid_line_positions(const SensorRectangle& area);
/// `count` x `count` positions over the rectangle, row by row from its left bottom corner; `count` at least 2.
[[nodiscard]] std::vector<Point> grid_positions(const SensorRectangle& area, std::size_t count);

/// A point load at every position with every load, load by load.
[[nodiscard]] std::vector<CopTrial> point_trials(std::span<const Point> positions, std::span<const double> loads_n);
/// `count` random stances on `feet` (1 or 2) feet with heel and forefoot patches as StandingPerson makes them, with random shares of
/// the weight and loads evenly within `load_n`. The same seed gives the same stances. Fewer than `count` on a plate too small for most.
[[nodiscard]] std::vector<CopTrial> foot_trials(const Plate& plate, std::size_t feet, std::size_t count, Interval load_n,
                                                std::uint64_t seed);

}  // namespace dts::physics
