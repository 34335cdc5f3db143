// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "device/sim/chair/chair_options.h"

namespace dts::device::sim {
namespace {

constexpr std::size_t kChairSensors = 16;

core::Result<ChairOptions> read_chair(const std::string& options) {
  return read_chair_options(*DeviceUri::parse(options.empty() ? "sim:chair" : "sim:chair?" + options), kChairSensors);
}

std::string chair_refusal(const std::string& options) {
  const auto read_options = read_chair(options);
  return read_options ? "" : core::to_string(read_options.error());
}

TEST(ChairOptions, NothingGiven_AHealthyPersonWhoReachesByItself) {
  const auto options = read_chair("");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->sensors, 16U);
  EXPECT_FALSE(options->has_emg);
  EXPECT_TRUE(options->has_truth);
  EXPECT_EQ(options->daq.bits, 16);
  EXPECT_EQ(options->person.person.weight_kg, 70.0);
  EXPECT_EQ(options->person.mode, physics::ReachMode::Auto);
  EXPECT_EQ(options->person.habits.arm_use, 1.0);
  EXPECT_EQ(options->person.habits.load.model, physics::SeatLoadModel::Cop);
  EXPECT_EQ(options->fault.kind, FaultKind::None);
}

TEST(ChairOptions, ThePerson_IsTaken) {
  const auto options =
      read_chair("weight_kg=52&height_cm=165&arm_length_cm=59&max_reach_cm=115&group=stroke&reaches=cued&pace_s=1.5&stand_up_s=60");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->person.person.height_cm, 165.0);
  EXPECT_EQ(options->person.habits.load.weight_kg, 52.0);
  EXPECT_EQ(options->person.habits.phase_s, 1.5);
  EXPECT_EQ(options->person.habits.phase_growth_per_deg, 0.0);
  EXPECT_LT(options->person.habits.arm_use, 1.0);
  EXPECT_EQ(options->person.mode, physics::ReachMode::Cued);
  EXPECT_EQ(options->person.stand_up_s, 60.0);
  EXPECT_EQ(read_chair("back_rest=0")->person.habits.load.lean_back_deg, 0.0);
  EXPECT_EQ(read_chair("load_model=thesis")->person.habits.load.model, physics::SeatLoadModel::Thesis);
}

TEST(ChairOptions, SensorFaults_Recognised) {
  const auto options = read_chair("dead=1,4&saturated=9&swapped=1:12&sensor_fault_at_s=20");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->sensor_faults.dead, (std::vector<std::size_t>{1, 4}));
  EXPECT_EQ(options->sensor_faults.saturated, (std::vector<std::size_t>{9}));
  EXPECT_EQ(options->sensor_faults.swapped, (std::pair<std::size_t, std::size_t>{1, 12}));
  EXPECT_EQ(options->sensor_faults.from_s, 20.0);
}

TEST(ChairOptions, WhatDoesNothingOrIsNotThere_Refused) {
  for (const auto& [options, reason] : {std::pair{"dead=16", "0 .. 15"},
                                        {"dead=1.5", "whole numbers"},
                                        {"saturated=3&sensors=3", "0 .. 2"},
                                        {"sensors=17", "the rig has 16"},
                                        {"fault=stuck&fault_channel=16", "fault_channel = 16"},
                                        {"reaches=none&pace_s=1", "only with reaches=auto|cued"},
                                        {"reaches=none&double_reach=1", "only with reaches=auto|cued"},
                                        {"load_model=thesis&back_rest=0", "only with load_model=cop"},
                                        {"sensor_fault_at_s=3", "only with dead="},
                                        {"fault_for_s=3", "only with fault="},
                                        {"fault=silence&fault_channel=1", "only with fault=stuck"},
                                        {"sit_down_s=5&stand_up_s=6", "stand_up_s"}}) {
    EXPECT_NE(chair_refusal(options).find(reason), std::string::npos) << options << ": " << chair_refusal(options);
  }
  for (const char* bad : {"1", "1:", ":1", "1:1", "1:16", "a:b", "1:2x", "-1:2", "1:2:3", "99999999999999999999:1"}) {
    EXPECT_NE(chair_refusal(std::string("swapped=") + bad).find("swapped"), std::string::npos) << bad;
  }
  EXPECT_EQ(chair_refusal("fault=stuck&fault_channel=16&aux=emg"), "");
}

TEST(ChairOptions, EveryNumber_RefusedJustOutsideItsRange) {
  for (const UriOption& option : chair_option_table()) {
    if (option.kind == OptionKind::Word || option.kind == OptionKind::Text) continue;
    SCOPED_TRACE(std::string(option.name));
    const std::string below = chair_refusal(std::string(option.name) + "=" + std::to_string(option.minimum - 1.0));
    EXPECT_NE(below.find(allowed(option)), std::string::npos) << below;
    if (option.maximum == kNever) continue;
    const std::string above = chair_refusal(std::string(option.name) + "=" + std::to_string(option.maximum + 1.0));
    EXPECT_NE(above.find(allowed(option)), std::string::npos) << above;
  }
}

TEST(ChairOptions, Readme_ListsEveryOptionWithDefaultAndRange) {
  std::ifstream file(std::string(DTS_SOURCE_DIR) + "/daemon/device/sim/chair/README.md");
  ASSERT_TRUE(file.is_open());
  std::stringstream readme;
  readme << file.rdbuf();

  for (const UriOption& option : chair_option_table()) {
    std::string range = allowed(option);
    for (std::size_t bar = range.find('|'); bar != std::string::npos; bar = range.find('|', bar + 2)) range.replace(bar, 1, "\\|");
    const std::string row = "| `" + std::string(option.name) + "` | " + range + " | " + std::string(option.default_text) + " |";
    EXPECT_NE(readme.str().find(row), std::string::npos) << "README.md lacks: " << row;
  }
}

}  // namespace
}  // namespace dts::device::sim
