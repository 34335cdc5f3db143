// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "physics/plate/plate.h"

namespace dts::device::sim {

/// A calibration weight at one point of the plate.
struct Weight {
  physics::Point position;  ///< From a corner of the plate, as in physics.
  double load_n = 0.0;
};

inline constexpr std::size_t kMaxWeights = 1000;

/// Reads a CSV file with the header `x_mm,y_mm,load_n`; positions are from the plate's centre, as the options `x_mm` and `y_mm`. Fails with
/// NotFound, or with InvalidArgument, naming "file:line", if a weight is off the plate or outside 1..2000 N.
[[nodiscard]] core::Result<std::vector<Weight>> load_weights(const std::string& path, const physics::Plate& plate);

}  // namespace dts::device::sim
