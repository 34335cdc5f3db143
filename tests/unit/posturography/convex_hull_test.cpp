// SPDX-License-Identifier: Apache-2.0
#include "posturography/convex_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

using Column = std::vector<double>;

TEST(ConvexHull, SquareWithPointsInsideAndOnItsEdges) {
  const Column x = {0, 4, 4, 0, 2, 2, 0, 4, 1};
  const Column y = {0, 0, 3, 3, 1, 0, 2, 3, 1};

  const auto hull = convex_hull(x, y);

  EXPECT_EQ(hull, (std::vector<Point>{{0, 0}, {4, 0}, {4, 3}, {0, 3}}));
  EXPECT_EQ(area_mm2(hull), 12.0);
  EXPECT_EQ(diameter_mm(hull), 5.0);
}

TEST(ConvexHull, DegenerateClouds) {
  EXPECT_TRUE(convex_hull({}, {}).empty());
  EXPECT_EQ(convex_hull(Column{2, 2, 2}, Column{1, 1, 1}), (std::vector<Point>{{2, 1}}));
  const std::vector<Point> beside = {{2, 1}, {7, 5}, {3, 9}};  // outside of the span: does not count
  EXPECT_EQ(diameter_mm(std::span(beside).first(1)), 0.0);
  EXPECT_EQ(diameter_mm(std::span(beside).first(2)), std::hypot(5.0, 4.0));
  EXPECT_EQ(area_mm2(std::span(beside).first(2)), 0.0);
  EXPECT_EQ(area_mm2(beside), 18.0);
  const auto line = convex_hull(Column{0, 1, 2, 3}, Column{0, 1, 2, 3});
  EXPECT_EQ(line, (std::vector<Point>{{0, 0}, {3, 3}}));
  EXPECT_EQ(diameter_mm(line), std::hypot(3.0, 3.0));
  EXPECT_EQ(area_mm2(line), 0.0);
}

TEST(ConvexHull, HoldsEveryPointAndItsDiameterIsTheLargestDistanceOfTwo) {
  test::Noise noise(11);
  for (int cloud = 0; cloud < 300; ++cloud) {
    const auto count = static_cast<std::size_t>(2.0 + 40.0 * noise.uniform());
    const bool is_coarse = cloud % 3 == 0;  // few places: equal points, points on lines, parallel edges
    Column x(count);
    Column y(count);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = is_coarse ? std::round(2.0 * noise.normal()) : 8.0 * noise.normal();
      y[i] = is_coarse ? std::round(2.0 * noise.normal()) : noise.normal();
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < i; ++j) largest = std::max(largest, std::hypot(x[i] - x[j], y[i] - y[j]));
    }

    const auto hull = convex_hull(x, y);

    EXPECT_EQ(diameter_mm(hull), largest) << "cloud " << cloud;
    for (std::size_t edge = 0; edge < hull.size(); ++edge) {
      const Point& a = hull[edge];
      const Point& b = hull[(edge + 1) % hull.size()];
      for (std::size_t i = 0; i < count; ++i) EXPECT_GE((b.x - a.x) * (y[i] - a.y) - (b.y - a.y) * (x[i] - a.x), 0.0) << "cloud " << cloud;
    }
  }
}

TEST(ConvexHull, CircleOfManyCorners) {
  // All pairs of 100 000 corners would be 5e9.
  constexpr std::size_t kCount = 100'000;
  Column x(kCount);
  Column y(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / kCount;
    x[i] = 10.0 * std::cos(phase);
    y[i] = 10.0 * std::sin(phase);
  }

  const auto hull = convex_hull(x, y);

  EXPECT_NEAR(diameter_mm(hull), 20.0, 1e-12);
  EXPECT_NEAR(area_mm2(hull), 100.0 * std::numbers::pi, 1e-5);
}

}  // namespace
}  // namespace dts::posturography
