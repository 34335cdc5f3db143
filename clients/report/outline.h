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

/// Which samples a drawing needs, in order: of every stretch of samples those with the extremes of both, its first and its last. No peak is
/// lost, and about `most` are left. Samples that are NaN stand for the gap they are part of: one of each gap is kept.
[[nodiscard]] std::vector<std::size_t> thinned(std::span<const double> first, std::span<const double> second, std::size_t most);

/// SVG path data, two decimals; a point that is not finite ends the line, and the next finite one begins another. A lone point becomes a
/// line of no length, which round caps would show and others do not: it gets 0.01.
[[nodiscard]] std::string path_data(std::span<const PlotPoint> points);

/// [begin, end) of every run of NaN.
struct Gap {
  std::size_t begin = 0;
  std::size_t end = 0;
};
[[nodiscard]] std::vector<Gap> gaps_of(std::span<const double> values);

}  // namespace dts::report
