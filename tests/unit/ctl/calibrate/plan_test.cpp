// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ctl/calibrate/picture.h"

namespace dts::ctl {
namespace {

using physics::CopMethod;
using ::testing::HasSubstr;

/// The thesis's platform.
PlateView platform() {
  return {.a_mm = 430.0,
          .b_mm = 430.0,
          .labels = {"w1", "w2", "w3", "w4"},
          .sensor_x_mm = {86.0, 344.0, 86.0, 344.0},
          .sensor_y_mm = {86.0, 86.0, 344.0, 344.0}};
}

TEST(Plan, Thesis_FivePointsOnEachMidLine) {
  const auto points = plan_points(platform(), CopMethod::Thesis, {490.0}, 7);

  ASSERT_EQ(points.size(), 10U);
  const std::vector<double> positions{86.0, 150.5, 215.0, 279.5, 344.0};  // plate-model 5.1
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(points[k], (PlannedPoint{positions[k], 215.0, 490.0}));
    EXPECT_EQ(points[5 + k], (PlannedPoint{215.0, positions[k], 490.0}));
  }
}

TEST(Plan, Poly3_GridToAndFroPerLoad) {
  const auto points = plan_points(platform(), CopMethod::Poly3, {240.0, 700.0}, 7);

  ASSERT_EQ(points.size(), 98U);
  EXPECT_EQ(points[0], (PlannedPoint{86.0, 86.0, 240.0}));
  EXPECT_EQ(points[6], (PlannedPoint{344.0, 86.0, 240.0}));
  EXPECT_EQ(points[7], (PlannedPoint{344.0, 129.0, 240.0}));  // back again: the short way
  EXPECT_EQ(points[13], (PlannedPoint{86.0, 129.0, 240.0}));
  EXPECT_EQ(points[49], (PlannedPoint{86.0, 86.0, 700.0}));
  EXPECT_EQ(points[97], (PlannedPoint{344.0, 344.0, 700.0}));
}

TEST(Plan, Verification_IsTable41) {
  const auto points = verification_points(platform(), 490.0, kVerificationPoints);

  const std::vector<std::pair<double, double>> table{{86, 86},       {86, 118.25},  {118.25, 118.25}, {86, 150.5},     {118.25, 150.5},
                                                     {150.5, 150.5}, {86, 182.75},  {118.25, 182.75}, {150.5, 182.75}, {182.75, 182.75},
                                                     {86, 215},      {118.25, 215}, {150.5, 215},     {182.75, 215},   {215, 215}};
  ASSERT_EQ(points.size(), table.size());
  for (std::size_t k = 0; k < table.size(); ++k) EXPECT_EQ(points[k], (PlannedPoint{table[k].first, table[k].second, 490.0})) << k;
}

TEST(Plan, FewerVerificationPoints_ReachFromTheCornerToTheCentre) {
  EXPECT_TRUE(verification_points(platform(), 490.0, 0).empty());
  const auto three = verification_points(platform(), 490.0, 3);
  EXPECT_EQ(three.front(), (PlannedPoint{86.0, 86.0, 490.0}));
  EXPECT_EQ(three.back(), (PlannedPoint{215.0, 215.0, 490.0}));
}

TEST(Picture, Spot_IsWhereItIsAndForwardIsUp) {
  const std::string picture = spot_picture(platform(), {344.0, 387.0, 490.0});

  std::vector<std::string> lines;
  std::istringstream stream(picture);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 19U);
  EXPECT_EQ(lines[1 + 2][3 + 26], 'X');  // 0.9 of the way to the front, 0.8 of the way to the right
  EXPECT_EQ(lines[1 + 13][3 + 6], 'o');  // w1: left back
  EXPECT_EQ(lines[1 + 3][3 + 6], 'o');   // w3: left front
}

TEST(Picture, ErrorMap_SymbolPerPointAndFiguresPerLoad) {
  std::vector<PointError> errors;
  for (const auto& [x, y, error] :
       {std::tuple{86.0, 86.0, 0.05}, std::tuple{344.0, 86.0, 0.2}, std::tuple{86.0, 344.0, 0.9}, std::tuple{344.0, 344.0, 3.0}}) {
    errors.push_back({.point = {x, y, 240.0}, .x_error_mm = error, .y_error_mm = 0.0});
  }
  errors.push_back({.point = {215.0, 215.0, 700.0}, .x_error_mm = 0.3, .y_error_mm = 0.4});

  const std::string map = error_map(errors);

  EXPECT_THAT(map, HasSubstr("240 N: rms 1.57 mm, at most 3.00 mm\n   344   O  #\n    86   .  o\n"));
  EXPECT_THAT(map, HasSubstr("700 N: rms 0.50 mm, at most 0.50 mm\n   215   O\n"));
}

}  // namespace
}  // namespace dts::ctl
