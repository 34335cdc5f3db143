// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lab/force/force_file.h"

namespace dts::lab::force {

/// Returns what contradicts itself in the signs of a plate; nothing is turned.
/// - The vertical force points down while the plate is loaded (the mean of loaded samples is 100 N or more). Up is known from the corners of a
///   C3D file, and in OpenSim; in other files, a negative force is reported.
/// - Shear and COP contradict each other: a standing person is a pendulum, so the shear on the person follows -p'' between 0.2 and 1 Hz.
///   Both horizontal axes must correlate with one sign. Only for quiet standing on one plate: 20 s or more, the load within 10 %.
[[nodiscard]] std::vector<std::string> sign_warnings(const ForceFile& file, std::size_t plate, double least_force_n);

}  // namespace dts::lab::force
