// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace dts::posturography {

struct Point {
  double x = 0.0;
  double y = 0.0;

  friend bool operator==(const Point&, const Point&) = default;
};

/// The corners of the convex hull, counter-clockwise, each once; two for points on a line, one when all are equal. By monotone chain
/// (Andrew 1979), O(N log N). The columns are equally long and finite. Thread: any.
[[nodiscard]] std::vector<Point> convex_hull(std::span<const double> x, std::span<const double> y);

/// The largest distance between any two corners, by rotating calipers: O(corners), since a recorded circle has as many as samples.
[[nodiscard]] double diameter_mm(std::span<const Point> hull) noexcept;
[[nodiscard]] double area_mm2(std::span<const Point> hull) noexcept;

}  // namespace dts::posturography
