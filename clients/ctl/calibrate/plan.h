// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dts/v1/control.pb.h"
#include "physics/cop/cop_estimator.h"

namespace dts::ctl {

/// A known load at a known place. Plate coordinates, corner origin, mm.
struct PlannedPoint {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double load_n = 0.0;

  friend bool operator==(const PlannedPoint&, const PlannedPoint&) = default;
};

/// The plate from above, with the geometry for drawing and naming places.
struct PlateView {
  double a_mm = 0.0;
  double b_mm = 0.0;
  std::vector<std::string> labels;  ///< Of the sensors.
  std::vector<double> sensor_x_mm;
  std::vector<double> sensor_y_mm;
};

[[nodiscard]] PlateView plate_view(const v1::RigInfo& rig);

/// Returns the load points in the order of measurement: at each load row by row, in alternating directions, so that the distances for the
/// weight are short. Thesis (4.4): five equally spaced points on each mid-line between the sensors, with the centre in both. Poly3: grid x
/// grid points over the rectangle of the sensors.
[[nodiscard]] std::vector<PlannedPoint> plan_points(const PlateView& plate, physics::CopMethod method, const std::vector<double>& loads_n,
                                                    std::size_t grid);

inline constexpr std::size_t kVerificationPoints = 15;

/// Returns the points of thesis Table 4.1 in its order (for the thesis's platform exactly its coordinates), evenly reduced to `count`.
[[nodiscard]] std::vector<PlannedPoint> verification_points(const PlateView& plate, double load_n, std::size_t count);

}  // namespace dts::ctl
