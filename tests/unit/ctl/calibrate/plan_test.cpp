// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/plan.h"

#include <gtest/gtest.h>

#include "ctl/calibrate/picture.h"
#include "support/committed_text.h"

namespace dts::ctl {
namespace {

using physics::CopMethod;

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
  dts::test::expect_committed("unit/ctl/calibrate/said/" + dts::test::case_file(), spot_picture(platform(), {344.0, 387.0, 490.0}));
}

TEST(Picture, ErrorMap_SymbolPerPointAndFiguresPerLoad) {
  std::vector<PointError> errors;
  for (const auto& [x, y, error] :
       {std::tuple{86.0, 86.0, 0.05}, std::tuple{344.0, 86.0, 0.2}, std::tuple{86.0, 344.0, 0.9}, std::tuple{344.0, 344.0, 3.0}}) {
    errors.push_back({.point = {x, y, 240.0}, .x_error_mm = error, .y_error_mm = 0.0});
  }
  errors.push_back({.point = {215.0, 215.0, 700.0}, .x_error_mm = 0.3, .y_error_mm = 0.4});

  dts::test::expect_committed("unit/ctl/calibrate/said/" + dts::test::case_file(), error_map(errors));
}

}  // namespace
}  // namespace dts::ctl
