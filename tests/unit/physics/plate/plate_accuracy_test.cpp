// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "physics/plate/plate.h"
#include "unit/physics/floor_platform.h"

// Thesis Table 3.6: how much the ratio of two sensors depends on where along a line the load stands. Its figures are missing;
// configuration and numbers are those of the plate study (two independent computations agree on them).

namespace dts::physics {
namespace {

using test::acrylic_plate;
using test::at;
using test::RefinedPlate;

using Lines = std::array<double, 5>;

/// Mean deviation in percent of the ratio of two sensors from that at the line's first point.
template <class Positions>
double deviation_percent(const RefinedPlate& plate, std::size_t first, std::size_t second, const Positions& line, std::size_t divisor) {
  const auto ratio = [&](const Point& load) { return plate.under_point(first, load) / plate.under_point(second, load); };
  double sum = 0.0;
  for (const Point& load : line) sum += std::abs(ratio(load) / ratio(line.front()) - 1.0);
  return 100.0 * sum / static_cast<double>(divisor);
}

/// Neighbouring sensors w1, w2: five lines towards w1, from the mid-line on, each from the sensors' line to the plate's middle.
Lines neighbours(const Support& support) {
  const RefinedPlate plate(acrylic_plate(), support, test::floor_sensors());
  Lines result{};
  for (std::size_t k = 0; k < result.size(); ++k) {
    std::vector<Point> line;
    for (const double y : {86.0, 118.25, 150.5, 182.75, 215.0}) line.push_back(at(215.0 - 32.25 * static_cast<double>(k), y));
    result[k] = deviation_percent(plate, 0, 1, line, line.size() - 1);
  }
  return result;
}

/// Opposite sensors w1, w4: lines square to their diagonal, from the plate's centre towards w1.
Lines opposites(const Support& support) {
  constexpr double kPitchMm = 29.5;
  const RefinedPlate plate(acrylic_plate(), support, test::floor_sensors());
  Lines result{};
  for (std::size_t k = 0; k < result.size(); ++k) {
    const double start = 215.0 - 0.5 * kPitchMm * static_cast<double>(k);
    std::vector<Point> line;
    for (std::size_t step = 0; step < 7 - k; ++step) {
      line.push_back(at(start - kPitchMm * static_cast<double>(step), start + kPitchMm * static_cast<double>(step)));
    }
    result[k] = deviation_percent(plate, 0, 3, line, line.size());
  }
  return result;
}

void expect_lines(const Lines& lines, const Lines& expected) {
  for (std::size_t k = 0; k < lines.size(); ++k) EXPECT_NEAR(lines[k], expected[k], 0.02 * expected[k] + 1e-4) << "line " << k + 1;
}

TEST(PlateAccuracy, NeighbouringSensors_ReproduceTheStudy) {
  expect_lines(neighbours(test::edges()), {0.0, 9.5, 18.5, 27.4, 35.2});
  expect_lines(neighbours(test::corners(0.0)), {0.0, 0.49, 0.99, 1.64, 2.25});
}

TEST(PlateAccuracy, OppositeSensors_ReproduceTheStudy) {
  expect_lines(opposites(test::edges()), {0.0, 4.16, 5.85, 5.67, 4.15});
  expect_lines(opposites(test::corners(0.0)), {0.0, 2.31, 2.27, 1.54, 0.75});
}

}  // namespace
}  // namespace dts::physics
