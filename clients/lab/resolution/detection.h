// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace dts::lab::resolution {

/// Values of one measure in several reaches of one person that turn the trunk equally far.
struct Level {
  double turn_deg = 0.0;
  std::vector<double> values;
};

/// One measure of one person's reaches to one target.
struct Series {
  std::vector<double> none;   ///< With the arm alone.
  std::vector<Level> levels;  ///< In ascending order; all series of a person have the same turns.
};

/// A smallest turn of the trunk, deg. Empty: it is beyond the largest level.
using Limit = std::optional<double>;

/// Returns the smallest turn that `reaches` reaches distinguish from none with an error of 5 % in both directions: the limit of detection
/// after L. A. Currie, Anal. Chem. 40 (1968) 586, for the difference of two means. The mean of `reaches` reaches with the arm alone is
/// subtracted, so their scatter counts twice. A difference counts as a movement above the threshold that 5 % of the differences without
/// movement exceed; the limit is the turn at which 95 % of the differences are above it. With several series, one of them is enough, and
/// the 5 % are divided among them (Bonferroni). Between two levels the limit is interpolated; from it on, all levels are above.
[[nodiscard]] Limit detection_limit(std::span<const Series> series, int reaches);

/// The limit and its 95 % interval over repeated studies of the same person (bootstrap over the reaches).
struct LimitInterval {
  Limit value;
  Limit lowest;
  Limit highest;
};
[[nodiscard]] LimitInterval with_interval(std::span<const Series> series, int reaches, std::uint64_t seed);

/// Returns the quantile `part` (0..1) of limits, of which empty ones are the largest; empty without limits.
[[nodiscard]] Limit quantile(std::vector<Limit> limits, double part);
/// Returns the median over people with its 95 % interval over repeated draws of as many people (bootstrap over the people).
[[nodiscard]] LimitInterval median_over_people(const std::vector<Limit>& limits, std::uint64_t seed);

}  // namespace dts::lab::resolution
