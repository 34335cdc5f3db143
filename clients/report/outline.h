// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace dts::report {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

/// Returns the samples that a drawing needs, in order: for each stretch, the samples with the extremes of both series, the first and the
/// last. No peak is lost, and about `most` samples remain. Keeps one NaN sample of each gap.
[[nodiscard]] std::vector<std::size_t> thinned(std::span<const double> first, std::span<const double> second, std::size_t most);

/// Returns SVG path data with two decimals. A point that is not finite ends the line; the next finite point starts a new one. A lone point
/// becomes a line of length 0.01, because some programs do not show a line of length 0.
[[nodiscard]] std::string path_data(std::span<const PlotPoint> points);

/// The range [begin, end) of a run of NaN.
struct Gap {
  std::size_t begin = 0;
  std::size_t end = 0;
};
[[nodiscard]] std::vector<Gap> gaps_of(std::span<const double> values);

}  // namespace dts::report
