// SPDX-License-Identifier: Apache-2.0
#include "posturography/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dts::posturography {
namespace {

/// Returns twice the area of the triangle, above 0 if it turns left.
double turn(const Point& a, const Point& b, const Point& c) noexcept { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

double distance(const Point& a, const Point& b) noexcept { return std::hypot(a.x - b.x, a.y - b.y); }

/// Adds a corner to a chain that turns only left; may remove corners from `begin` on.
void append(std::vector<Point>& chain, std::size_t begin, const Point& point) {
  while (chain.size() >= begin + 2 && turn(chain[chain.size() - 2], chain.back(), point) <= 0.0) chain.pop_back();
  chain.push_back(point);
}

}  // namespace

std::vector<Point> convex_hull(std::span<const double> x, std::span<const double> y) {
  std::vector<Point> points(x.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {x[i], y[i]};
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;

  std::vector<Point> hull;
  for (const Point& point : points) append(hull, 0, point);
  const std::size_t upper = hull.size() - 1;  // the chain back starts at the rightmost point
  for (std::size_t i = points.size() - 1; i-- > 0;) append(hull, upper, points[i]);
  hull.pop_back();  // the leftmost point, which is there twice
  return hull;
}

double diameter_mm(std::span<const Point> hull) noexcept {
  const std::size_t count = hull.size();
  if (count < 2) return 0.0;
  double largest = 0.0;
  std::size_t across = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const Point& begin = hull[i];
    const Point& end = hull[(i + 1) % count];
    // The corner farthest from this edge; it only advances while the edges turn, once around in total.
    for (std::size_t steps = 0; steps < count; ++steps) {
      const std::size_t next = (across + 1) % count;
      largest = std::max({largest, distance(begin, hull[next]), distance(end, hull[next])});
      if (turn(begin, end, hull[next]) <= turn(begin, end, hull[across])) break;
      across = next;
    }
    largest = std::max({largest, distance(begin, hull[across]), distance(end, hull[across])});
  }
  return largest;
}

double area_mm2(std::span<const Point> hull) noexcept {
  if (hull.size() < 3) return 0.0;
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) twice += turn(hull[0], hull[i], hull[i + 1]);
  return 0.5 * twice;
}

}  // namespace dts::posturography
