// SPDX-License-Identifier: Apache-2.0
#include "files/rig_model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace dts::files {
namespace {

const std::string kFloorRig = std::string(DTS_SOURCE_DIR) + "/config/rigs/floor-sim.toml";

RigModelFile read(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  if (!table) return {};
  TomlReader top(&*table, "", file, problems);
  return read_rig_model(top, problems);
}

TEST(RigModelFile, ReadsThePlatformOfTheThesis) {
  Problems problems;
  const auto rig = read(kFloorRig, problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_DOUBLE_EQ(rig.model.plate.a.value, 430.0);
  EXPECT_DOUBLE_EQ(rig.model.support.inset.value, 10.75);
  ASSERT_EQ(rig.model.sensors.size(), 4U);
  EXPECT_EQ(rig.model.sensors[3].label, "w4");
  EXPECT_THAT(rig.sensor_channels, testing::ElementsAre(0, 1, 2, 3));
}

TEST(RigModelFile, LeavesTheRestOfTheFileAlone) {
  Problems problems;
  (void)read(kFloorRig, problems);  // the file has [acquire] and [[stage]] too
  EXPECT_TRUE(problems.empty());
}

TEST(RigModelFile, ReportsAWrongValueWithItsPlaceAndRange) {
  const std::string file = testing::TempDir() + "/wrong_rig.toml";
  std::ofstream(file) << "[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = -3.0\ne_pa = 2e11\nnu = 0.3\n[support]\nkind = \"corner\"\n";
  Problems problems;
  (void)read(file, problems);
  ASSERT_EQ(problems.size(), 2U);  // and no [[sensor]]
  EXPECT_EQ(problems[0].line, 4U);
  EXPECT_THAT(problems[0].text, testing::HasSubstr("0.1 .. 100"));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace dts::files
