// SPDX-License-Identifier: Apache-2.0
// A rig's file with [force_plate] instead of [plate], [support] and [[sensor]].
#include <gmock/gmock.h>

#include <array>
#include <tuple>

#include "files/rig_file.h"
#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kBoard = R"(kind = "floor"
[force_plate]
kind = "load_cells"
position_mm = [[200, 150], [-200, 150], [-200, -150], [200, -150]]
scale_n_per_v = [100.0, 100.0, 100.0, 100.0]
axes = "z_up"
size_mm = [500, 400]
ml = "+x"
ap = "+y"
[acquire]
rate_hz = 100.0
[[stage]]
id = "guard"
[[stage]]
id = "force_plate"
[[stage]]
id = "force_cop"
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

class RigFileForcePlate : public FilesTest {
 protected:
  static pipeline::RigConfig read(const std::string& text) {
    Problems problems;
    auto config = read_rig_text(text, "rig", problems);
    EXPECT_TRUE(problems.empty()) << to_string(problems.front());
    return config;
  }
  /// The first problem.
  static std::string problem(const std::string& text) {
    Problems problems;
    (void)read_rig_text(text, "rig", problems);
    return problems.empty() ? "none" : to_string(problems.front());
  }
};

TEST_F(RigFileForcePlate, APlateWithoutNamesAndChannels_HasThoseOfItsKind) {
  const pipeline::RigConfig rig = read(kBoard);

  ASSERT_TRUE(rig.model.force_plate);
  EXPECT_TRUE(rig.model.sensors.empty());
  EXPECT_THAT(physics::input_names(rig.model), ElementsAre("cell1", "cell2", "cell3", "cell4"));
  EXPECT_THAT(rig.sensor_channels, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(rig.model.force_plate->tare_v, ElementsAre(0, 0, 0, 0));
  EXPECT_EQ(rig.model.plate.a.value, 500.0);
  EXPECT_EQ(rig.model.plate.b.value, 400.0);
  EXPECT_FALSE(rig.model.force_plate->mounting.is_z_down);
}

TEST_F(RigFileForcePlate, EveryKeyOfItsPlaceInTheRig_ReachesItsField) {
  std::string text = replaced(kBoard, "ml = \"+x\"\nap = \"+y\"",
                              "ml = \"-y\"\nap = \"+x\"\nchannels = [7, 5, 3, 1]\nnames = [\"a\", \"b\", \"c\", \"d\"]");
  text = replaced(text, "[acquire]", "[force_plate.tare]\nvolts = [1, 2, 3, 4]\n[acquire]");

  const pipeline::RigConfig rig = read(text);

  EXPECT_THAT(physics::input_names(rig.model), ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(rig.sensor_channels, ElementsAre(7, 5, 3, 1));
  EXPECT_THAT(rig.model.force_plate->tare_v, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(rig.model.force_plate->mounting.ml, physics::PlateAxis::MinusY);
  EXPECT_EQ(rig.model.force_plate->mounting.ap, physics::PlateAxis::PlusX);
  EXPECT_EQ(rig.model.plate.a.value, 400.0) << "ML is along the plate's y";
  EXPECT_EQ(rig.model.plate.b.value, 500.0);
}

TEST_F(RigFileForcePlate, WhatIsWrong_IsNamed) {
  for (const auto& [what, by, text] : std::initializer_list<std::array<const char*, 3>>{
           {"ml = \"+x\"\n", "", "[force_plate] ml is missing"},
           {"ap = \"+y\"\n", "", "[force_plate] ap is missing"},
           {"ap = \"+y\"", "ap = \"+x\"", "along the same axis"},
           {"ap = \"+y\"", "ap = \"-y\"", "z would point down"},
           {"ap = \"+y\"", "ap = \"forward\"", "is not known"},
           {"size_mm = [500, 400]\n", "", "size_mm is missing"},
           {"size_mm = [500, 400]", "size_mm = [500, 5]", "a side is shorter than 10 mm"},
           {"size_mm = [500, 400]", "size_mm = [500]", "size_mm"},
           {"ap = \"+y\"", "ap = \"+y\"\nchannels = [0, 1, 2]", "the plate has 4 channels, but 3 are named"},
           {"ap = \"+y\"", "ap = \"+y\"\nchannels = [0, 1, 2, 2]", "channel 2 is named twice"},
           {"ap = \"+y\"", "ap = \"+y\"\nchannels = [0, 1, 2, 32]", "channels must hold whole numbers"},
           {"ap = \"+y\"", "ap = \"+y\"\nnames = [\"a\", \"b\", \"c\"]", "4 channels, but 3 names"},
           {"ap = \"+y\"", "ap = \"+y\"\nnames = [\"a\", \"b\", \"c\", \"a\"]", "each name must be there once"},
           {"ap = \"+y\"", "ap = \"+y\"\nsise_mm = 3", "unknown key 'sise_mm' in [force_plate]; did you mean 'size_mm'?"},
           {"[acquire]", "[plate]\na_mm = 430\n[acquire]", "a rig with [force_plate] has no [plate]: remove it"},
           {"[acquire]", "[[sensor]]\nlabel = \"w1\"\n[acquire]", "has no [sensor]"},
           {"[acquire]", "[trigger]\nchannel = 3\n[acquire]", "channel 3 belongs to a sensor"},
       }) {
    EXPECT_THAT(problem(replaced(kBoard, what, by)), HasSubstr(text)) << by;
  }
}

TEST_F(RigFileForcePlate, AnAxisThatIsMissing_IsTheOnlyProblem) {
  for (const char* const axis : {"ml = \"+x\"\n", "ap = \"+y\"\n"}) {
    Problems problems;
    (void)read_rig_text(replaced(kBoard, axis, ""), "rig", problems);
    EXPECT_EQ(problems.size(), 1U) << axis;
  }
  Problems problems;
  (void)read_rig_text(replaced(kBoard, "ap = \"+y\"\n", "ap = \"forward\"\n"), "rig", problems);
  EXPECT_EQ(problems.size(), 1U);
}

TEST_F(RigFileForcePlate, ItsDefinition_IsReadAsTheSameRig) {
  const auto definition = rig_definition(write("board.toml", kBoard));
  ASSERT_TRUE(definition) << core::to_string(definition.error());

  const pipeline::RigConfig rig = read(*definition);

  EXPECT_EQ(physics::input_names(rig.model).size(), 4U);
  EXPECT_EQ(rig.model.force_plate->plate.wrench(std::vector<double>{1, 0, 0, 0}).force_n[2], 100.0);
}

TEST_F(RigFileForcePlate, NothingIsCalibrated) {
  Problems problems;
  (void)read_rig_to_calibrate(write("board.toml", kBoard), problems);

  ASSERT_FALSE(problems.empty());
  EXPECT_THAT(to_string(problems.front()), HasSubstr("a force plate has the calibration of its maker"));
}

TEST_F(RigFileForcePlate, TheExamples_AreRead) {
  for (const auto& [name, channels, has_shear] :
       {std::tuple{"force-plate-kistler", 8U, true}, {"force-plate-amti", 6U, true}, {"balance-board", 4U, false}}) {
    Problems problems;
    const auto rig = read_rig_file((kConfig / "rigs" / (std::string(name) + ".toml")).string(), problems);
    ASSERT_TRUE(problems.empty()) << to_string(problems.front());
    EXPECT_EQ(physics::input_names(rig.model).size(), channels) << name;
    EXPECT_EQ(rig.model.force_plate->plate.measures_shear(), has_shear) << name;
  }
}

}  // namespace
}  // namespace dts::files
