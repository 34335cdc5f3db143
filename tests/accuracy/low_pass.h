// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace dts::accuracy {

/// One factor of a filter: y = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2) x.
struct Section {
  double b0, b1, b2, a1, a2;
};

/// Butterworth low-pass of order 4 as two sections of gain 1 at 0 Hz (bilinear transform, prewarped at the cut).
/// `cut_hz` must lie between 0 and half of `rate_hz`.
[[nodiscard]] std::array<Section, 2> butterworth4(double cut_hz, double rate_hz);

/// Profile `lp10` of the posturography sheet, section 2: butterworth4 at 10 Hz forward and backward, with 15 samples of odd
/// reflection at both ends. Direct form would lose digits at 1500 Hz, hence the sections. Empty for less than 16 samples.
[[nodiscard]] std::vector<double> lp10(std::span<const double> samples, double rate_hz);

/// Every n-th sample, beginning with the first; `step` at least 1.
[[nodiscard]] std::vector<double> every_nth(std::span<const double> samples, std::size_t step);

}  // namespace dts::accuracy
