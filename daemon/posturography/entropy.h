// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace dts::posturography {

/// Returns the sample entropy (Richman & Moorman 2000): -ln(A/B) over template pairs of length m and m + 1, N - m templates for both,
/// Chebyshev distance <= r times the population SD, no self matches. Returns nothing if A or B is 0, the series is constant or not finite,
/// or m = 0. O(N^2) in the worst case, but compares only pairs whose first values are near. Thread: any.
[[nodiscard]] std::optional<double> sample_entropy(std::span<const double> values, std::size_t m = 2, double r = 0.2);

}  // namespace dts::posturography
