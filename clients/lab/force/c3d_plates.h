// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/force/force_file.h"

namespace dts::lab::force {

/// Reads the force platforms of a C3D file, types 1 to 4, with the sign of the file:
/// - 1: M = P x F + (0, 0, Tz); ORIGIN and ZERO have no meaning
/// - 2: F and M of the channels; 3: eight channels of Kistler, ORIGIN = (a, b, az0); 4: CAL_MATRIX (column-major) x channels
/// - 2 to 4: then M += F x o, where o is ORIGIN. An ORIGIN with z > 0 is the opposite vector: types 2 and 4 turn all of it, type 3 turns
/// only
///   z, because a and b are distances (BTK does the same).
/// Lengths are in POINT:UNITS. A plate that cannot be read has a warning and empty samples. Fails with Failed if there is no usable plate.
[[nodiscard]] core::Result<ForceFile> read_c3d_plates(const std::string& file, std::string bytes, const ReadOptions& options);

}  // namespace dts::lab::force
