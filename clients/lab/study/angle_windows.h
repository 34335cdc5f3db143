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

/// Trunk angles of H1 to H10 in reaches to one target: as the thesis measured them with a camera, and as the geometry of target and body
/// predicts them from the same measures (reach-model section 3).
struct AngleWindow {
  std::string_view condition;
  std::array<double, 10> measured_deg{};
  std::array<double, 10> geometry_deg{};
  Window measured;
  Window geometry;
  double bias_deg = 0.0;  ///< Mean of geometry minus measured.
  double rms_deg = 0.0;
};

/// Returns the windows for 120 %, 150 % and the maximum.
[[nodiscard]] std::array<AngleWindow, 3> angle_windows();

}  // namespace dts::lab::study
