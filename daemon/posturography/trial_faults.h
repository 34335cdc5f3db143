// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "posturography/cop_series.h"

namespace dts::posturography {

inline constexpr double kTimeSlackS = 1e-9;  ///< 5 samples of 100 Hz are 50 ms, however it is divided.

/// The load is below half of its median for more than 50 ms, from sample `first` on: somebody stepped off. The median is that of the
/// samples at which the load is above 0. false: no load is known. Thread: any.
[[nodiscard]] bool load_goes_away(const CopSeries& series, std::size_t first);

/// The centre of pressure jumps from one place to another, from sample `first` on: within 100 ms it goes more than 20 mm (200 mm/s), and
/// the means of 200 ms before and after that are more than 25 mm apart. Quiet standing with closed eyes reaches 5 and 9 mm. The values are
/// finite. Thread: any.
[[nodiscard]] bool position_jumps(std::span<const double> ml_mm, std::span<const double> ap_mm, std::size_t first, double rate_hz);

}  // namespace dts::posturography
