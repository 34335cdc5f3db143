// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/force/force_file.h"

namespace dts::lab::force {

/// Adds to the warnings of each plate what contradicts itself in its signs; nothing is turned.
/// - The vertical force points down while the plate is loaded: the mean of the samples with 100 N or more. Up is known from the corners of
///   a C3D file, and in OpenSim; in other files, a negative force is reported.
/// - Shear and COP contradict each other: a standing subject is a pendulum, m x'' = m g / l (x - p), whose centre of mass x moves less
///   than the COP p. So the shear on the subject follows p'' between 0.2 and 1 Hz (r = 0.9 on recordings), that on the plate -p''.
///   Both horizontal axes must correlate with one sign. Only for quiet standing on one plate: 20 s or more, the load within 10 %.
void add_sign_warnings(ForceFile& file, double least_force_n);

}  // namespace dts::lab::force
