// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/plot.h"
#include "physics/plate/solve.h"

namespace dts::lab {

/// Draws a map of the bent plate with supports, loads (patches as rectangles) and probes.
[[nodiscard]] core::Status plot_plate(const physics::PlateCase& plate_case, const physics::PlateSolution& solution,
                                      const std::string& file);

/// Returns the point supports, or some points along supported edges, as marks.
[[nodiscard]] Marks support_marks(const physics::Plate& plate, const physics::Support& support);

}  // namespace dts::lab
