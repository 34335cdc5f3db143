// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/base/plot.h"
#include "physics/plate/solve.h"

namespace dts::lab::plate {

/// Draws a map of the bent plate with supports, loads (patches as rectangles) and probes.
[[nodiscard]] core::Status plot_plate(const physics::PlateCase& plate_case, const physics::PlateSolution& solution,
                                      const std::string& file);

}  // namespace dts::lab::plate
