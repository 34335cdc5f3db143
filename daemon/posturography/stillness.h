// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace dts::posturography {

/// Of at least one value.
[[nodiscard]] inline double mean_of(std::span<const double> values) noexcept {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// What is left of a constant after filtering and centring is rounding of its level, and has no spectrum and no diffusion: such a series
/// counts as constant. No platform resolves a ten-thousand-millionth of where somebody stands.
[[nodiscard]] inline bool is_still(std::span<const double> values, double level) noexcept {
  if (values.empty()) return true;
  const auto [least, most] = std::ranges::minmax_element(values);
  return *most - *least <= 1e-10 * std::abs(level);
}

}  // namespace dts::posturography
