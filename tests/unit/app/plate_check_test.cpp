// SPDX-License-Identifier: Apache-2.0
#include "app/plate_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dts::app {
namespace {

using ::testing::HasSubstr;

/// The shipped configuration, its floor rigs with plates of this thickness.
DaemonConfig shipped(std::optional<double> thickness_mm) {
  LoadedConfig loaded = load_config(std::string(DTS_SOURCE_DIR) + "/config/dtsd.toml");
  EXPECT_TRUE(loaded.problems.empty());
  for (ConfiguredRig& configured : loaded.config.rigs) {
    if (thickness_mm && configured.rig.kind == "floor") configured.rig.model.plate.h = {*thickness_mm};
  }
  return loaded.config;
}

TEST(PlateWarnings, ShippedRigs_None) { EXPECT_TRUE(plate_warnings(shipped({})).empty()); }

TEST(PlateWarnings, PlateThatBendsBeyondItsModel_NamedWithPlaceAndFigures) {
  const auto warnings = plate_warnings(shipped(1.0));

  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_GT(warnings[0].line, 0U);
  EXPECT_THAT(to_string(warnings[0]), HasSubstr("dtsd.toml:"));
  EXPECT_THAT(warnings[0].text, HasSubstr("[[rig]] 'floor'"));
  EXPECT_THAT(warnings[0].text, HasSubstr("of a person of 686 N, more than 2.5 times its thickness (1.0 mm)"));
}

TEST(PlateWarnings, RealRigWithItsOwnCalibration_NeedsNoPlateModel) {
  DaemonConfig config = shipped(1.0);
  for (ConfiguredRig& configured : config.rigs) {
    if (configured.rig.kind != "floor") continue;
    physics::RigModel thick = configured.rig.model;
    thick.plate.h = {3.0};
    auto estimator = physics::CopEstimator::from_model(physics::CopMethod::Poly3, thick);
    ASSERT_TRUE(estimator);
    configured.rig.cop_calibration = physics::CopCalibration{.id = "own", .origin = {}, .estimator = std::move(*estimator), .points = {}};
    EXPECT_EQ(plate_warnings(config).size(), 1U) << "a simulated rig bends by the model all the same";
    configured.rig.device_uri = "ni6008:1234";
  }
  EXPECT_TRUE(plate_warnings(config).empty());
}

TEST(PlateWarnings, ForcePlate_NeedsNoPlateModel) {
  DaemonConfig config = shipped(1.0);
  const physics::LoadCellPlate cells{.cells = {{200, 150, 100}, {-200, 150, 100}, {0, -150, 100}}};
  for (ConfiguredRig& configured : config.rigs) {
    configured.rig.model.force_plate = physics::ForcePlateModel{
        .plate = physics::ForcePlate::create(cells).value(), .channel_names = {"cell1", "cell2", "cell3"}, .tare_v = {0.0, 0.0, 0.0}};
  }
  EXPECT_TRUE(plate_warnings(config).empty());
}

}  // namespace
}  // namespace dts::app
