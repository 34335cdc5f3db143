// SPDX-License-Identifier: Apache-2.0
#include "files/rig_model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

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

TEST(RigModelFile, ReportsAWrongValueWithItsPlaceAndRange) {
  const std::string file = testing::TempDir() + "/wrong_rig_" + std::to_string(::getpid()) + ".toml";
  std::ofstream(file) << "[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = -3.0\ne_pa = 2e11\nnu = 0.3\n[support]\nkind = \"corner\"\n";
  Problems problems;
  (void)read(file, problems);
  ASSERT_EQ(problems.size(), 2U);  // and no [[sensor]]
  EXPECT_EQ(problems[0].line, 4U);
  EXPECT_THAT(problems[0].text, testing::HasSubstr("0.01 .. 86"));
  std::filesystem::remove(file);
}

/// Whether [plate] and [support] of a file are accepted.
bool is_accepted(const std::string& text) {
  const std::string file = testing::TempDir() + "/limits_rig.toml";
  std::ofstream(file) << text;
  Problems problems;
  const auto table = parse_toml(file, problems);
  TomlReader top(&*table, "", file, problems);
  const physics::Plate plate = read_plate(top.table("plate"));
  (void)read_support(top.table("support"), plate);
  std::filesystem::remove(file);
  return problems.empty();
}

TEST(RigModelFile, TakesExactlyWhatPhysicsTakes) {
  const auto agree = [](const physics::Plate& plate, const physics::Support& support) {
    constexpr std::array<const char*, 4> kKinds{"corner", "edges", "x-edges", "clamped"};
    std::ostringstream text;
    text.precision(17);
    text << "[plate]\na_mm = " << plate.a.value << "\nb_mm = " << plate.b.value << "\nh_mm = " << plate.h.value << "\ne_pa = " << plate.e_pa
         << "\nnu = " << plate.nu << "\n[support]\nkind = \"" << kKinds[static_cast<std::size_t>(support.kind)]
         << "\"\ninset_mm = " << support.inset.value << "\n";
    const bool is_physical = physics::check_plate(plate) && physics::check_support(plate, support);
    EXPECT_EQ(is_accepted(text.str()), is_physical) << text.str();
    return is_physical;
  };
  using physics::SupportKind;

  for (const SupportKind kind : {SupportKind::Corner, SupportKind::Edges, SupportKind::XEdges, SupportKind::Clamped}) {
    EXPECT_TRUE(agree({}, {.kind = kind}));
  }
  EXPECT_TRUE(agree({.nu = -0.999999}, {}));
  EXPECT_FALSE(agree({.nu = -1.0}, {}));
  EXPECT_TRUE(agree({.nu = 0.499999}, {}));
  EXPECT_FALSE(agree({.nu = 0.5}, {}));
  EXPECT_TRUE(agree({.h = {0.01}}, {}));
  EXPECT_FALSE(agree({.h = {0.0099}}, {}));
  EXPECT_TRUE(agree({.h = {86.0}}, {}));
  EXPECT_FALSE(agree({.h = {86.1}}, {}));
  EXPECT_TRUE(agree({.a = {10.0}, .b = {10.0}, .h = {1.0}}, {}));
  EXPECT_FALSE(agree({.a = {9.9}, .b = {10.0}, .h = {1.0}}, {}));
  EXPECT_TRUE(agree({.a = {10'000.0}, .b = {10'000.0}}, {}));
  EXPECT_FALSE(agree({.a = {10'001.0}, .b = {10'000.0}}, {}));
  EXPECT_TRUE(agree({.a = {200.0}, .b = {10.0}, .h = {1.0}}, {}));
  EXPECT_FALSE(agree({.a = {201.0}, .b = {10.0}, .h = {1.0}}, {}));
  EXPECT_TRUE(agree({.e_pa = 1e5}, {}));
  EXPECT_FALSE(agree({.e_pa = 9e4}, {}));
  EXPECT_FALSE(agree({.e_pa = 1.1e13}, {}));
  EXPECT_TRUE(agree({}, {.inset = {214.9}}));
  EXPECT_FALSE(agree({}, {.inset = {215.0}}));
  EXPECT_FALSE(agree({}, {.inset = {-0.1}}));
}

TEST(RigModelFile, CurveThatDoesNotReachTheUnloadedPlateOrASensorTwice_IsReported) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "/short_curve.toml") << "name = \"short\"\n[[point]]\ngap_mm = 7\nvolts = 4\n[[point]]\ngap_mm = 9\nvolts = 2\n"
                                                 "[[point]]\ngap_mm = 11\nvolts = 1\n";
  const std::string file = folder + "/short_rig.toml";
  std::ofstream(file)
      << "[plate]\na_mm = 430\nb_mm = 430\nh_mm = 3\ne_pa = 2e11\nnu = 0.3\n[support]\nkind = \"corner\"\n"
         "[[sensor]]\nlabel = \"w1\"\nx_mm = 86\ny_mm = 86\ncurve = \"short_curve.toml\"\n"
         "[[sensor]]\nlabel = \"w1\"\nchannel = 0\nunloaded_gap_mm = 10\nx_mm = 99\ny_mm = 86\ncurve = \"short_curve.toml\"\n";
  Problems problems;
  (void)read(file, problems);
  ASSERT_EQ(problems.size(), 3U);
  EXPECT_EQ(problems[0].line, 13U);
  EXPECT_THAT(problems[0].text, testing::HasSubstr("7 .. 11 mm, without the unloaded plate's 12 mm"));
  EXPECT_THAT(problems[1].text, testing::HasSubstr("channel 0 already belongs to another sensor"));
  EXPECT_THAT(problems[2].text, testing::HasSubstr("another sensor is labelled 'w1' too"));
}

TEST(RigModelFile, FolderOrHugeFile_IsNoToml) {
  Problems problems;
  EXPECT_FALSE(parse_toml(testing::TempDir(), problems));
  const std::string huge = testing::TempDir() + "/huge.toml";
  std::ofstream(huge) << std::string(5U << 20U, '#');
  EXPECT_FALSE(parse_toml(huge, problems));
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_THAT(problems[0].text, testing::HasSubstr("folder"));
  EXPECT_THAT(problems[1].text, testing::HasSubstr("4 MiB"));
  std::filesystem::remove(huge);
}

}  // namespace
}  // namespace dts::files
