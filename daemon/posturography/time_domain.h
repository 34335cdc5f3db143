// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "posturography/measure.h"
#include "posturography/prepare.h"

namespace dts::posturography {

/// Adds distances, path, ranges, areas, ellipse, hybrid measures (posturography sheet section 3). O(N log N).
void add_time_domain(const Prepared& prepared, Measures& measures);
inline constexpr double kHeadingRateHz = 25.0;

/// Adds VMAX, AAMV (Delignieres et al. 2011), heading change at 25 Hz (Rhea et al. 2014, experimental), AP_USE (section 6).
void add_velocity_and_direction(const Prepared& prepared, std::optional<double> foot_length_mm, Measures& measures);

}  // namespace dts::posturography
