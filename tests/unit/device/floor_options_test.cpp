// SPDX-License-Identifier: Apache-2.0
#include "device/sim/floor_options.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <utility>

namespace dts::device::sim {
namespace {

constexpr std::size_t kFloorSensors = 4;

core::Result<FloorOptions> read_floor(const std::string& options) {
  return read_floor_options(*DeviceUri::parse(options.empty() ? "sim:floor" : "sim:floor?" + options), kFloorSensors);
}

std::string floor_refusal(const std::string& options) {
  const auto read_options = read_floor(options);
  return read_options ? "" : core::to_string(read_options.error());
}

TEST(FloorOptions, NothingGiven_TheThesisRigWithAPerson) {
  const auto options = read_floor("");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->stance.kind, physics::ContactKind::Feet);
  EXPECT_EQ(options->stance.load.value, 686.0);
  EXPECT_EQ(options->daq.bits, 11);
  EXPECT_EQ(options->daq.range_v, 5.0);
  EXPECT_DOUBLE_EQ(options->daq.noise_v, 3e-3);
  EXPECT_EQ(options->sensors, 4U);
  EXPECT_EQ(options->extra, 0U);
  EXPECT_TRUE(options->has_truth);
  EXPECT_EQ(options->fault.kind, FaultKind::None);
}

TEST(FloorOptions, EachContactAndFault_TakesItsOwnOptions) {
  const auto point = read_floor("contact=point&load_n=196&x_mm=-129&y_mm=64.5");
  ASSERT_TRUE(point.has_value());
  EXPECT_EQ(point->stance.kind, physics::ContactKind::Point);
  EXPECT_EQ(point->stance.load.value, 196.0);
  EXPECT_EQ(point->stance.centre_ml.value, -129.0);
  EXPECT_EQ(point->stance.centre_ap.value, 64.5);
  const auto weights = read_floor("contact=weights&weights=a.csv&step_on_s=4&hold_s=2&pause_s=0&ramp_s=0.1&loop=1");
  ASSERT_TRUE(weights.has_value());
  EXPECT_EQ(weights->contact, FloorContact::Weights);
  EXPECT_EQ(weights->weights_file, "a.csv");
  EXPECT_EQ(weights->placement.first_s, 4.0);
  EXPECT_EQ(weights->placement.hold_s, 2.0);
  EXPECT_EQ(weights->placement.pause_s, 0.0);
  EXPECT_EQ(weights->placement.ramp_s, 0.1);
  EXPECT_TRUE(weights->placement.repeats);
  const auto gaps = read_floor("contact=gaps&gaps_mm=12,9.5,7");
  ASSERT_TRUE(gaps.has_value());
  EXPECT_EQ(gaps->contact, FloorContact::Gaps);
  EXPECT_EQ(gaps->gaps_mm, (std::vector<double>{12.0, 9.5, 7.0}));
  EXPECT_EQ(read_floor("fault=unplug")->fault.kind, FaultKind::Unplug);
  EXPECT_EQ(read_floor("fault=overrun")->fault.kind, FaultKind::Overrun);
  EXPECT_EQ(read_floor("fault=stuck&fault_channel=2")->fault.channel, 2U);
  EXPECT_EQ(read_floor("fault=silence&fault_at_s=3&fault_for_s=1.5")->fault.for_s, 1.5);
}

TEST(FloorOptions, EveryNumber_RefusedJustOutsideItsRange) {
  for (const UriOption& option : floor_option_table()) {
    if (option.kind == OptionKind::Word || option.kind == OptionKind::File) continue;
    SCOPED_TRACE(std::string(option.name));
    const std::string below = floor_refusal(std::string(option.name) + "=" + std::to_string(option.minimum - 1.0));
    EXPECT_NE(below.find(allowed(option)), std::string::npos) << below;
    if (option.maximum == kNever) continue;
    const std::string above = floor_refusal(std::string(option.name) + "=" + std::to_string(option.maximum + 1.0));
    EXPECT_NE(above.find(allowed(option)), std::string::npos) << above;
  }
}

TEST(FloorOptions, WhatDoesNothingIsMissingOrTooMuch_Refused) {
  for (const auto& [options, reason] : {std::pair{"contact=weights", "contact=weights needs weights="},
                                        {"contact=gaps", "contact=gaps needs gaps_mm="},
                                        {"contact=gaps&gaps_mm=12&hold_s=0&pause_s=0.0009&ramp_s=0", "shorter than 1 ms"},
                                        {"load_n=100", "only with contact=point"},
                                        {"contact=point&weight_n=100", "only with contact=feet"},
                                        {"contact=point&cop=a.csv", "only with contact=feet"},
                                        {"loop=1", "only with cop=FILE or contact=weights|gaps"},
                                        {"contact=point&loop=1", "only with cop=FILE"},
                                        {"hold_s=1", "only with contact=weights|gaps"},
                                        {"contact=gaps&gaps_mm=12&gap_spread_mm=0", "only with contact=feet|point|weights"},
                                        {"contact=gaps&gaps_mm=12&plate=linear", "only with contact=feet|point|weights"},
                                        {"weights=a.csv", "only with contact=weights"},
                                        {"contact=weights&weights=a.csv&x_mm=1", "only with contact=feet|point"},
                                        {"contact=gaps&gaps_mm=12&step_off_s=9", "only with contact=feet|point"},
                                        {"fault_at_s=1", "only with fault="},
                                        {"fault=silence&fault_channel=1", "only with fault=stuck"},
                                        {"sensors=5", "the rig has 4"},
                                        {"extra=26", "at most 32"},  // 4 + 25 + 3 truth channels = 32
                                        {"fault=stuck&fault_channel=4", "fault_channel = 4"}}) {
    EXPECT_NE(floor_refusal(options).find(reason), std::string::npos) << options << ": " << floor_refusal(options);
  }
  for (const char* options : {"contact=gaps&gaps_mm=12&hold_s=0&pause_s=0.001&ramp_s=0", "sensors=4", "extra=25", "extra=28&truth=0",
                              "fault=stuck&fault_channel=4&extra=1"}) {
    EXPECT_EQ(floor_refusal(options), "") << options;
  }
}

TEST(FloorOptions, Readme_ListsEveryOptionWithDefaultAndRange) {
  std::ifstream file(std::string(DTS_SOURCE_DIR) + "/daemon/device/sim/README.md");
  ASSERT_TRUE(file.is_open());
  std::stringstream readme;
  readme << file.rdbuf();

  for (const UriOption& option : floor_option_table()) {
    std::string range = allowed(option);
    for (std::size_t bar = range.find('|'); bar != std::string::npos; bar = range.find('|', bar + 2)) range.replace(bar, 1, "\\|");
    const std::string row = "| `" + std::string(option.name) + "` | " + range + " | " + std::string(option.default_text) + " |";
    EXPECT_NE(readme.str().find(row), std::string::npos) << "README.md lacks: " << row;
  }
}

}  // namespace
}  // namespace dts::device::sim
