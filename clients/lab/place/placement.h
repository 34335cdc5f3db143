// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/result.h"
#include "physics/cop/sensed_plate.h"
#include "physics/rig_model.h"

namespace dts::lab::place {

/// Errors of one sensor layout, all rms and radial.
struct PlacementFigures {
  double distance_mm = 0.0;  ///< Of the outermost sensors from the edges of the plate.
  /// Cramer-Rao limit for a point load of 490 N with unknown position and load: one filtered scan (3 mV rms noise, 4.88 mV steps, window 3)
  /// of sensors with the rig's curve, over the middle 60 % of the plate.
  double noise_limit_mm = 0.0;
  double one_foot_mm = 0.0;  ///< Noise-free error under random stances: poly3 with four sensors, moment with more.
  double two_feet_mm = 0.0;
  double standing_mm = 0.0;  ///< Noise limit combined with the mean square of both stances.
};

struct Placement {
  std::vector<PlacementFigures> rows;  ///< In order of rising distance.
  std::size_t best_standing = 0;       ///< Row with the smallest `standing_mm`.
  std::size_t best_point_load = 0;     ///< Row with the smallest `noise_limit_mm`.
};

/// Returns a symmetric layout: 4 sensors on the diagonals; 8 with the centres of the sides between them; 16 on a 4 x 4 grid.
[[nodiscard]] std::vector<physics::Point> sensor_layout(const physics::Plate& plate, std::size_t sensor_count, double distance_mm);

/// Computes the errors of one layout on the rig's plate, with the curve and gap of the rig's first sensor. `sensor_count`: 4, 8 or 16.
/// Fails as InfluenceTable and CopEstimator::from_model.
[[nodiscard]] core::Result<PlacementFigures> placement_figures(const physics::RigModel& rig, std::size_t sensor_count, double distance_mm,
                                                               physics::PlateBehaviour behaviour);

/// Tries every distance in steps of 5 mm from 20 mm to a third of the shorter side. Also fails if the plate is too small for these.
[[nodiscard]] core::Result<Placement> place_sensors(const physics::RigModel& rig, std::size_t sensor_count,
                                                    physics::PlateBehaviour behaviour, const std::function<void(double)>& report_progress);

}  // namespace dts::lab::place
