// SPDX-License-Identifier: Apache-2.0
#include "lab/place/placement.h"

#include "lab/base/thesis_setup.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::place {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

physics::Point at(double x_mm, double y_mm) { return {{x_mm}, {y_mm}}; }

TEST(SensorLayout, FourEightSixteen_AreSymmetricAndInTheOrderOfTheRig) {
  const physics::Plate plate{.a = {430.0}, .b = {330.0}};

  EXPECT_THAT(sensor_layout(plate, 4, 30.0), ElementsAre(at(30, 30), at(400, 30), at(30, 300), at(400, 300)));
  EXPECT_THAT(sensor_layout(plate, 8, 30.0),
              ElementsAre(at(30, 30), at(215, 30), at(400, 30), at(30, 165), at(400, 165), at(30, 300), at(215, 300), at(400, 300)));
  const auto sixteen = sensor_layout(plate, 16, 65.0);
  ASSERT_EQ(sixteen.size(), 16U);
  EXPECT_EQ(sixteen[5], at(165.0, 65.0 + 200.0 / 3.0));
}

// The study behind plate-model section 6 (inset 10.75, 490 N): noise limit 0.75 / 0.43 / 0.32 / 0.28 / 0.30 mm and two-feet error
// 2.9 / 3.4 / 4.1 / 5.5 / 8.6 mm at 43 / 64 / 86 / 106 / 130 mm; its stances were other random ones.
TEST(PlacementFigures, FourUnderThePlatform_AsTheStudyFound) {
  struct Expected {
    double distance_mm, noise_limit_mm, two_feet_mm;
  };
  for (const auto& [distance_mm, noise_limit_mm, two_feet_mm] :
       {Expected{43.0, 0.75, 2.9}, Expected{64.0, 0.43, 3.4}, Expected{86.0, 0.32, 4.1}, Expected{106.0, 0.28, 5.5},
        Expected{130.0, 0.30, 8.6}}) {
    const auto figures = placement_figures(thesis_setup::floor_platform(), 4, distance_mm, physics::PlateBehaviour::Stiffening);

    ASSERT_TRUE(figures) << figures.error().what;
    EXPECT_NEAR(figures->noise_limit_mm, noise_limit_mm, 0.01) << distance_mm;
    EXPECT_NEAR(figures->two_feet_mm, two_feet_mm, 0.1 * two_feet_mm) << distance_mm;
    EXPECT_LT(figures->one_foot_mm, figures->two_feet_mm) << distance_mm;
  }
}

TEST(PlaceSensors, Best_IsNearTheSupportsForPeopleAndFartherInForPoints) {
  double last_progress = -1.0;
  const auto placement = place_sensors(thesis_setup::floor_platform(), 4, physics::PlateBehaviour::Linear, [&](double fraction) {
    EXPECT_GT(fraction, last_progress);
    last_progress = fraction;
  });

  ASSERT_TRUE(placement) << placement.error().what;
  const double people_mm = placement->rows[placement->best_standing].distance_mm;
  EXPECT_GE(people_mm, 40.0) << "plate-model section 6: 43 to 64 mm";
  EXPECT_LE(people_mm, 65.0);
  EXPECT_GE(placement->rows[placement->best_point_load].distance_mm, 86.0);
  EXPECT_GT(last_progress, 0.95);
}

TEST(PlaceSensors, PlateTooSmall_IsRefused) {
  physics::RigModel rig = thesis_setup::floor_platform();
  rig.plate.a = {50.0};
  rig.plate.b = {50.0};

  EXPECT_FALSE(place_sensors(rig, 4, physics::PlateBehaviour::Linear, [](double) {}));
}

TEST_F(RunTest, PlaceWrongCount_ExitsWithTwo) { EXPECT_THAT(refusal_of({"place", "--sensors", "5"}), HasSubstr("--sensors")); }

}  // namespace
}  // namespace dts::lab::place
