// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace dts::posturography {

/// `values` must not be empty.
[[nodiscard]] inline double mean_of(std::span<const double> values) noexcept {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Returns whether a series is constant. Filtering and centring leave a rounding error relative to `level`, which has no meaningful
/// spectrum or diffusion. No platform resolves 1e-10 of the position.
[[nodiscard]] inline bool is_still(std::span<const double> values, double level) noexcept {
  if (values.empty()) return true;
  const auto [least, most] = std::ranges::minmax_element(values);
  return *most - *least <= 1e-10 * std::abs(level);
}

}  // namespace dts::posturography
