// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "posturography/cop_series.h"

namespace dts::posturography {

inline constexpr double kTimeSlackS = 1e-9;  ///< Tolerance for rounding: 5 samples at 100 Hz count as exactly 50 ms.

/// Returns true if the load is below half of its median for more than 50 ms, from sample `first` on: the subject stepped off. The median is
/// that of the samples with a load above 0. Returns false if no load is known. Thread: any.
[[nodiscard]] bool load_goes_away(const CopSeries& series, std::size_t first);

/// Returns true if the centre of pressure jumps from one place to another, from sample `first` on: it moves more than 20 mm within 100 ms
/// (200 mm/s), and the means of the 200 ms before and after that are more than 25 mm apart. Quiet standing with closed eyes reaches 5 and 9
/// mm. The values must be finite. Thread: any.
[[nodiscard]] bool position_jumps(std::span<const double> ml_mm, std::span<const double> ap_mm, std::size_t first, double rate_hz);

}  // namespace dts::posturography
