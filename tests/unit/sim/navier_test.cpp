// SPDX-License-Identifier: Apache-2.0
#include "sim/navier.h"

#include <gtest/gtest.h>

#include <array>

#include "physics/plate/influence_table.h"
#include "sim/chair_rig.h"
#include "unit/physics/floor_platform.h"

namespace dts::sim {
namespace {

using physics::test::at;

// Timoshenko and Woinowsky-Krieger, table 8: 0.00406 q a^4 / D in the middle of a square plate.
TEST(Navier, SquareUnderUniformLoad_AsTheTextbook) {
  const physics::Plate plate{
      .a = core::Millimetres{300.0}, .b = core::Millimetres{300.0}, .h = core::Millimetres{3.0}, .e_pa = 200e9, .nu = 0.3};
  const double per_n_mm = navier_mm_per_n(plate, at(150.0, 150.0), {.centre = at(150.0, 150.0), .width = plate.a, .height = plate.b});
  const double expected_mm = 1000.0 * 0.00406235 / (0.3 * 0.3) * 0.3 * 0.3 * 0.3 * 0.3 / plate.rigidity_nm();
  EXPECT_NEAR(per_n_mm, expected_mm, 1e-5 * expected_mm);
}

TEST(Navier, OfTheChair_NearTheHousesFiniteDifferences) {
  const physics::RigModel rig = chair_rig();
  const physics::Point probe = rig.sensors[9].position;
  const physics::Patch patch{.centre = at(200.0, 180.0), .width = core::Millimetres{240.0}, .height = core::Millimetres{200.0}};
  const std::array probes = {probe};
  const auto grid = physics::InfluenceTable::create(rig.plate, rig.support, probes);
  ASSERT_TRUE(grid.has_value());
  const double series_mm = navier_mm_per_n(rig.plate, probe, patch);
  EXPECT_NEAR(grid->under_patch_mm_per_n(0, patch), series_mm, 0.005 * series_mm);
}

TEST(Navier, WhatLiesBeyondTheEdge_PressesOnNothing) {
  const physics::RigModel rig = chair_rig();
  const physics::Point probe = rig.sensors[1].position;
  const auto under = [&](double y_mm, double depth_mm) {
    return navier_mm_per_n(rig.plate, probe,
                           {.centre = at(200.0, y_mm), .width = core::Millimetres{240.0}, .height = core::Millimetres{depth_mm}});
  };
  EXPECT_NEAR(under(0.0, 200.0), 0.5 * under(50.0, 100.0), 1e-9);
  EXPECT_EQ(under(-200.0, 200.0), 0.0);
}

}  // namespace
}  // namespace dts::sim
