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

/// Returns the corners of the convex hull, counter-clockwise, each once; two for points on a line, one if all points are equal. Monotone
/// chain (Andrew 1979), O(N log N). The columns must be finite and of the same length. Thread: any.
[[nodiscard]] std::vector<Point> convex_hull(std::span<const double> x, std::span<const double> y);

/// Returns the largest distance between any two corners. Rotating calipers, O(corners), because a circular path can have as many corners as
/// samples.
[[nodiscard]] double diameter_mm(std::span<const Point> hull) noexcept;
[[nodiscard]] double area_mm2(std::span<const Point> hull) noexcept;

}  // namespace dts::posturography
