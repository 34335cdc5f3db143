// SPDX-License-Identifier: Apache-2.0
#include "physics/force_plate/plate_inverse.h"

#include <gtest/gtest.h>

#include <vector>

namespace dts::physics {
namespace {

const Wrench kReaction{.force_n = {3.0, -5.0, 700.0}, .moment_nm = {12.0, -7.0, 0.6}};

/// Returns what the plate says about the channels that the inverse makes.
Wrench there_and_back(const ForcePlate& plate, const Mounting& mounting) {
  std::vector<double> channels(plate.channel_count());
  PlateInverse(plate, mounting).write_channels(kReaction, channels);
  return in_subject_frame(plate.wrench(channels), mounting);
}

void expect_near(const Wrench& found, const Wrench& wanted) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.force_n.at(i), wanted.force_n.at(i), 1e-9) << i;
    EXPECT_NEAR(found.moment_nm.at(i), wanted.moment_nm.at(i), 1e-9) << i;
  }
}

TEST(PlateInverse, EightChannels_MeanTheWrenchAndEachLegPushesUp) {
  KistlerPlate kistler{.a_mm = 120.0, .b_mm = 200.0, .az0_mm = -48.0};
  kistler.newtons_per_unit = {26.2, 26.5, 26.3, 26.3, 256.5, 257.1, 257.4, 257.0};
  const auto plate = ForcePlate::create(kistler);
  ASSERT_TRUE(plate);
  for (const Mounting& mounting : {Mounting{}, Mounting{.ml = PlateAxis::PlusY, .ap = PlateAxis::PlusX}}) {
    expect_near(there_and_back(*plate, mounting), kReaction);
  }
  std::vector<double> channels(8);
  PlateInverse(*plate, {}).write_channels(kReaction, channels);
  for (std::size_t leg = 4; leg < 8; ++leg) EXPECT_NEAR(channels[leg] * 257.0, 175.0, 40.0);
}

TEST(PlateInverse, SixComponentsWithCrossTalk_MeanTheWrench) {
  SixComponentPlate six{.surface_mm = {1.0, -2.0, -40.0}};
  for (std::size_t row = 0; row < kSixComponents; ++row) {
    for (std::size_t column = 0; column < kSixComponents; ++column) six.matrix.at(row).at(column) = row == column ? 100.0 : 1.0;
  }
  const auto plate = ForcePlate::create(six);
  ASSERT_TRUE(plate);
  expect_near(there_and_back(*plate, {}), kReaction);
}

TEST(PlateInverse, LoadCells_CarryTheVerticalForceOnly) {
  const auto plate = ForcePlate::create(
      LoadCellPlate{.cells = {{200.0, 150.0, 100.0}, {-200.0, 150.0, 100.0}, {-200.0, -150.0, 100.0}, {200.0, -150.0, 100.0}}});
  ASSERT_TRUE(plate);
  const Mounting board{.ml = PlateAxis::PlusX, .ap = PlateAxis::PlusY, .is_z_down = false};
  expect_near(there_and_back(*plate, board), {.force_n = {0.0, 0.0, 700.0}, .moment_nm = {12.0, -7.0, 0.0}});
}

}  // namespace
}  // namespace dts::physics
