// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace dts::lab::study {

struct Window {
  double least_deg = 0.0;
  double mean_deg = 0.0;
  double most_deg = 0.0;
};

/// Trunk angles of H1 to H10 in reaches to one target: what the thesis measured with a camera, and what the geometry of target and body
/// makes of the same measures (reach-model section 3).
struct AngleWindow {
  std::string_view condition;
  std::array<double, 10> measured_deg{};
  std::array<double, 10> geometry_deg{};
  Window measured;
  Window geometry;
  double bias_deg = 0.0;  ///< Geometry less measured, mean.
  double rms_deg = 0.0;
};

/// Of 120 %, 150 % and the maximum.
[[nodiscard]] std::array<AngleWindow, 3> angle_windows();

}  // namespace dts::lab::study
