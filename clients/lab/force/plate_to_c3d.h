// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/force/force_file.h"

namespace dts::lab::force {

/// Writes all plates of a file as C3D plates of type 1 (32-bit real numbers, Intel), with the events. Undefined values are NaN. Without
/// corners, a square of 400 mm around the origin stands for them. Adds what could not be kept to `warnings`. Fails with Failed.
[[nodiscard]] core::Status write_c3d(const ForceFile& file, double least_force_n, const std::string& out,
                                     std::vector<std::string>& warnings);

}  // namespace dts::lab::force
