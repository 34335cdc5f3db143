// SPDX-License-Identifier: Apache-2.0
#include "physics/force_plate/force_plate.h"

#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <limits>

namespace dts::physics {
namespace {

KistlerPlate kistler_9281ea() {
  KistlerPlate plate{.a_mm = 120.0, .b_mm = 200.0, .az0_mm = -48.0};
  plate.newtons_per_unit.fill(1.0);
  return plate;
}

SixBySix identity() {
  SixBySix matrix{};
  for (std::size_t i = 0; i < kSixComponents; ++i) matrix.at(i).at(i) = 1.0;
  return matrix;
}

TEST(ForcePlate, UndefinedChannel_LeavesTheOtherComponentsDefined) {
  const Wrench wrench =
      ForcePlate::create(SixComponentPlate{.matrix = identity()})->wrench(std::array{std::nan(""), 2.0, 3.0, 4.0, 5.0, 6.0});
  EXPECT_TRUE(std::isnan(wrench.force_n[0]));
  EXPECT_EQ(wrench.force_n[1], 2.0);
  EXPECT_EQ(wrench.moment_nm[2], 6.0);
}

TEST(KistlerPlateTest, PublishedExample_GivesForcesMomentsAboutTheSurfaceAndTheFreeMoment) {
  const auto plate = ForcePlate::create(kistler_9281ea());
  ASSERT_TRUE(plate);
  // Kistler, Force Plate Formulae: the surface is 48 mm above the plane of the sensors.
  const Wrench wrench = plate->wrench(std::array{5.0, 7.0, -4.0, -6.0, 200.0, 180.0, 150.0, 170.0});
  EXPECT_DOUBLE_EQ(wrench.force_n[0], 12.0);
  EXPECT_DOUBLE_EQ(wrench.force_n[1], -10.0);
  EXPECT_DOUBLE_EQ(wrench.force_n[2], 700.0);
  EXPECT_NEAR(wrench.moment_nm[0], 12.480, 1e-12);
  EXPECT_NEAR(wrench.moment_nm[1], -4.224, 1e-12);
  EXPECT_NEAR(wrench.moment_nm[2], 0.640, 1e-12);
  const ForcePoint point = force_point(wrench);
  EXPECT_NEAR(point.x_mm, 6.0343, 5e-5);
  EXPECT_NEAR(point.y_mm, 17.8286, 5e-5);
  EXPECT_NEAR(point.free_moment_nm, 0.914286, 5e-7);
}

TEST(KistlerPlateTest, ScalesDifferByChannel_EachIsApplied) {
  KistlerPlate plate = kistler_9281ea();
  for (std::size_t i = 0; i < kKistlerChannels; ++i) plate.newtons_per_unit.at(i) = static_cast<double>(i + 1);
  const auto scaled = ForcePlate::create(plate);
  ASSERT_TRUE(scaled);
  const Wrench wrench = scaled->wrench(std::array{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
  EXPECT_DOUBLE_EQ(wrench.force_n[0], 1.0 + 2.0);
  EXPECT_DOUBLE_EQ(wrench.force_n[1], 3.0 + 4.0);
  EXPECT_DOUBLE_EQ(wrench.force_n[2], 5.0 + 6.0 + 7.0 + 8.0);
}

TEST(KistlerPlateTest, WrongGeometryOrScale_IsRejectedByName) {
  auto plate = kistler_9281ea();
  plate.az0_mm = 48.0;
  const auto above = ForcePlate::create(plate);
  ASSERT_FALSE(above);
  EXPECT_NE(above.error().what.find("az0_mm"), std::string::npos);
  plate = kistler_9281ea();
  plate.a_mm = 0.0;
  EXPECT_FALSE(ForcePlate::create(plate));
  plate = kistler_9281ea();
  plate.newtons_per_unit[3] = 0.0;
  const auto dead = ForcePlate::create(plate);
  ASSERT_FALSE(dead);
  EXPECT_NE(dead.error().what.find("channel 4"), std::string::npos);
  plate.newtons_per_unit[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(ForcePlate::create(plate));
}

TEST(SixComponentPlateTest, SurfaceBesideAndAboveTheTransducer_MovesTheMoments) {
  // A force of (3, -2, 700) N at (10, 20) mm of the surface, whose centre is at (1, -2, -40) mm of the transducer.
  const std::array<double, 3> at_mm{11.0, 18.0, -40.0};
  const std::array<double, 3> f{3.0, -2.0, 700.0};
  const double mx = (at_mm[1] * f[2] - at_mm[2] * f[1]) / 1000.0;
  const double my = (at_mm[2] * f[0] - at_mm[0] * f[2]) / 1000.0;
  const double mz = (at_mm[0] * f[1] - at_mm[1] * f[0]) / 1000.0;
  const auto plate = ForcePlate::create(SixComponentPlate{.matrix = identity(), .surface_mm = {1.0, -2.0, -40.0}});
  ASSERT_TRUE(plate);
  const ForcePoint point = force_point(plate->wrench(std::array{f[0], f[1], f[2], mx, my, mz}));
  EXPECT_NEAR(point.x_mm, 10.0, 1e-9);
  EXPECT_NEAR(point.y_mm, 20.0, 1e-9);
  EXPECT_NEAR(point.free_moment_nm, 0.0, 1e-12);
}

TEST(SixComponentPlateTest, CrossTalk_IsTakenFromTheRowOfTheLoad) {
  SixBySix matrix = identity();
  matrix[0][2] = 0.02;  // Fz leaks into the channel of Fx
  const auto plate = ForcePlate::create(SixComponentPlate{.matrix = matrix});
  ASSERT_TRUE(plate);
  const Wrench wrench = plate->wrench(std::array{1.0, 0.0, 100.0, 0.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(wrench.force_n[0], 3.0);
  EXPECT_DOUBLE_EQ(wrench.force_n[2], 100.0);
}

TEST(SixComponentPlateTest, PublishedSensitivity_HasThePublishedInverse) {
  // AMTI's published pair: diagonals of both matrices, uV/(V N) and uV/(V N m).
  constexpr std::array kSensitivity{0.655, 0.650, 0.167, 1.348, 1.352, 2.552};
  constexpr std::array kCalibration{1.527, 1.539, 5.988, 0.742, 0.740, 0.392};
  SixBySix sensitivity{};
  for (std::size_t i = 0; i < kSixComponents; ++i) sensitivity.at(i).at(i) = kSensitivity.at(i);
  sensitivity[0][2] = -0.005;
  const auto calibration = calibration_from_sensitivity(sensitivity);
  ASSERT_TRUE(calibration);
  for (std::size_t i = 0; i < kSixComponents; ++i) EXPECT_NEAR(calibration->at(i).at(i), kCalibration.at(i), 0.0011) << i;
  EXPECT_NEAR(calibration->at(0).at(2), 0.046, 0.0005);  // 0.005 / (0.655 x 0.167)
}

TEST(SixComponentPlateTest, SingularSensitivity_IsRejected) {
  SixBySix sensitivity = identity();
  sensitivity[5] = sensitivity[4];
  const auto same = calibration_from_sensitivity(sensitivity);
  ASSERT_FALSE(same);
  EXPECT_NE(same.error().what.find("singular"), std::string::npos);
  sensitivity[5] = {};
  EXPECT_FALSE(calibration_from_sensitivity(sensitivity));
  sensitivity[5][5] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(calibration_from_sensitivity(sensitivity));
}

TEST(LoadCellPlateTest, WeightAtAPoint_IsFoundThereAndShearIsNotMeasured) {
  LoadCellPlate board;
  for (const auto& [x, y] : {std::pair{-200.0, -100.0}, std::pair{200.0, -100.0}, std::pair{200.0, 100.0}, std::pair{-200.0, 100.0}}) {
    board.cells.push_back({.x_mm = x, .y_mm = y, .newtons_per_unit = 50.0});
  }
  const auto plate = ForcePlate::create(board);
  ASSERT_TRUE(plate);
  EXPECT_FALSE(plate->measures_shear());
  const Wrench wrench = plate->wrench(std::array{1.0, 2.0, 4.0, 3.0});  // 500 N; x: (6 - 4)/10 x 200, y: (7 - 3)/10 x 100
  EXPECT_DOUBLE_EQ(wrench.force_n[2], 500.0);
  const ForcePoint point = force_point(wrench);
  EXPECT_NEAR(point.x_mm, 40.0, 1e-9);
  EXPECT_NEAR(point.y_mm, 40.0, 1e-9);
}

TEST(LoadCellPlateTest, CellsInALineOrTooFew_AreRejected) {
  LoadCellPlate board;
  for (const double x : {0.0, 100.0, 250.0}) board.cells.push_back({.x_mm = x, .y_mm = 0.001 * x, .newtons_per_unit = 1.0});
  const auto line = ForcePlate::create(board);
  ASSERT_FALSE(line);
  EXPECT_NE(line.error().what.find("in a line"), std::string::npos);
  board.cells.pop_back();
  EXPECT_FALSE(ForcePlate::create(board));
  board.cells.assign(3, {.x_mm = 1.0, .y_mm = 1.0, .newtons_per_unit = 1.0});
  EXPECT_FALSE(ForcePlate::create(board)) << "all at one place";
}

TEST(PointPolynomialTest, PublishedCoefficients_GiveThePublishedCorrection) {
  // 9281E/EA, serial numbers from 616902 on.
  const PointPolynomial polynomial{.x = {7.92063e-15, -5.821e-10, -2.77102e-6, -1.76083e-10, 1.29695e-5, -0.0413979}};
  const Wrench at_100_150{.force_n = {0.0, 0.0, 700.0}, .moment_nm = {700.0 * 0.150, -700.0 * 0.100, 0.0}};
  const ForcePoint point = corrected(at_100_150, polynomial);
  EXPECT_NEAR(100.0 - point.x_mm, 4.269, 0.0005);
  EXPECT_NEAR(point.y_mm, 150.0, 1e-9);
}

TEST(MountingTest, ActionWithZDown_BecomesTheReactionWithZUp) {
  const Mounting mounting{.ml = PlateAxis::PlusX, .ap = PlateAxis::MinusY, .is_z_down = true};
  ASSERT_TRUE(check(mounting));
  // The person pushes the plate to the plate's +x and +y (backwards): the reaction points left and forward.
  const Wrench reaction = in_subject_frame({.force_n = {5.0, 3.0, 700.0}, .moment_nm = {70.0, -35.0, 2.0}}, mounting);
  EXPECT_DOUBLE_EQ(reaction.force_n[0], -5.0);
  EXPECT_DOUBLE_EQ(reaction.force_n[1], 3.0);
  EXPECT_DOUBLE_EQ(reaction.force_n[2], 700.0);
  const ForcePoint point = force_point(reaction);
  EXPECT_NEAR(point.x_mm, 50.0, 1e-9);    // x of the plate: 35/700
  EXPECT_NEAR(point.y_mm, -100.0, 1e-9);  // y of the plate: 70/700, backwards
}

TEST(MountingTest, PlateTurnedByAQuarter_ExchangesTheAxes) {
  const Mounting mounting{.ml = PlateAxis::PlusY, .ap = PlateAxis::PlusX, .is_z_down = true};
  ASSERT_TRUE(check(mounting));
  const ForcePoint point = force_point(in_subject_frame({.force_n = {0, 0, 700.0}, .moment_nm = {70.0, -35.0, 0.0}}, mounting));
  EXPECT_NEAR(point.x_mm, 100.0, 1e-9);
  EXPECT_NEAR(point.y_mm, 50.0, 1e-9);
}

TEST(MountingTest, ReactionWithZUp_KeepsItsSigns) {
  const Mounting mounting{.ml = PlateAxis::PlusX, .ap = PlateAxis::PlusY, .is_z_down = false};
  ASSERT_TRUE(check(mounting));
  const Wrench given{.force_n = {1.0, 2.0, 700.0}, .moment_nm = {3.0, 4.0, 5.0}};
  const Wrench reaction = in_subject_frame(given, mounting);
  EXPECT_EQ(reaction.force_n, given.force_n);
  EXPECT_EQ(reaction.moment_nm, given.moment_nm);
}

TEST(MountingTest, LeftHandedOrParallelAxes_AreRejected) {
  EXPECT_FALSE(check({.ml = PlateAxis::PlusX, .ap = PlateAxis::PlusY, .is_z_down = true}));
  EXPECT_FALSE(check({.ml = PlateAxis::PlusX, .ap = PlateAxis::MinusY, .is_z_down = false}));
  EXPECT_FALSE(check({.ml = PlateAxis::PlusX, .ap = PlateAxis::MinusX, .is_z_down = true}));
  EXPECT_TRUE(check({.ml = PlateAxis::MinusY, .ap = PlateAxis::MinusX, .is_z_down = true}));
}

}  // namespace
}  // namespace dts::physics
