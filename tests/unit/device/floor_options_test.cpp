// SPDX-License-Identifier: Apache-2.0
#include "device/sim/floor_options.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

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

TEST(FloorOptions, Point_TakesItsOwnLoad) {
  const auto options = read_floor("contact=point&load_n=196&x_mm=-129&y_mm=64.5");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->stance.kind, physics::ContactKind::Point);
  EXPECT_EQ(options->stance.load.value, 196.0);
  EXPECT_EQ(options->stance.centre_ml.value, -129.0);
  EXPECT_EQ(options->stance.centre_ap.value, 64.5);
}

TEST(FloorOptions, Weights_TakeAListAndTimes) {
  const auto options = read_floor("contact=weights&weights=a.csv&step_on_s=4&hold_s=2&pause_s=0&ramp_s=0.1&loop=1");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->contact, FloorContact::Weights);
  EXPECT_EQ(options->weights_file, "a.csv");
  EXPECT_EQ(options->placement.first_s, 4.0);
  EXPECT_EQ(options->placement.hold_s, 2.0);
  EXPECT_EQ(options->placement.pause_s, 0.0);
  EXPECT_EQ(options->placement.ramp_s, 0.1);
  EXPECT_TRUE(options->placement.repeats);
}

TEST(FloorOptions, Gaps_TakeNumbers) {
  const auto options = read_floor("contact=gaps&gaps_mm=12,9.5,7");

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->contact, FloorContact::Gaps);
  EXPECT_EQ(options->gaps_mm, (std::vector<double>{12.0, 9.5, 7.0}));
}

TEST(FloorOptions, WeightsOrGapsWithoutTheirList_Refused) {
  EXPECT_NE(floor_refusal("contact=weights").find("contact=weights needs weights="), std::string::npos);
  EXPECT_NE(floor_refusal("contact=gaps").find("contact=gaps needs gaps_mm="), std::string::npos);
}

TEST(FloorOptions, NoTimeAtAll_Refused) {
  EXPECT_NE(floor_refusal("contact=gaps&gaps_mm=12&hold_s=0&pause_s=0&ramp_s=0").find("shorter than 1 ms"), std::string::npos);
}

TEST(FloorOptions, EachFault_Recognised) {
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

TEST(FloorOptions, OptionsThatDoNothing_Refused) {
  EXPECT_NE(floor_refusal("load_n=100").find("only with contact=point"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=point&weight_n=100").find("only with contact=feet"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=point&cop=a.csv").find("only with contact=feet"), std::string::npos);
  EXPECT_NE(floor_refusal("loop=1").find("only with cop=FILE or contact=weights|gaps"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=point&loop=1").find("only with cop=FILE"), std::string::npos);
  EXPECT_NE(floor_refusal("hold_s=1").find("only with contact=weights|gaps"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=gaps&gaps_mm=12&gap_spread_mm=0").find("only with contact=feet|point|weights"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=gaps&gaps_mm=12&plate=linear").find("only with contact=feet|point|weights"), std::string::npos);
  EXPECT_NE(floor_refusal("weights=a.csv").find("only with contact=weights"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=weights&weights=a.csv&x_mm=1").find("only with contact=feet|point"), std::string::npos);
  EXPECT_NE(floor_refusal("contact=gaps&gaps_mm=12&step_off_s=9").find("only with contact=feet|point"), std::string::npos);
  EXPECT_NE(floor_refusal("fault_at_s=1").find("only with fault="), std::string::npos);
  EXPECT_NE(floor_refusal("fault=silence&fault_channel=1").find("only with fault=stuck"), std::string::npos);
}

TEST(FloorOptions, MoreSensorsThanTheRigHas_Refused) {
  EXPECT_EQ(read_floor("sensors=4")->sensors, 4U);
  EXPECT_NE(floor_refusal("sensors=5").find("the rig has 4"), std::string::npos);
}

TEST(FloorOptions, MoreChannelsThanABlockHolds_Refused) {
  EXPECT_EQ(read_floor("extra=25")->extra, 25U);  // 4 + 25 + 3 truth channels = 32
  EXPECT_NE(floor_refusal("extra=26").find("at most 32"), std::string::npos);
  EXPECT_EQ(floor_refusal("extra=28&truth=0"), "");
}

TEST(FloorOptions, StuckChannelThatIsNoneOfTheConverters_Refused) {
  EXPECT_NE(floor_refusal("fault=stuck&fault_channel=4").find("fault_channel = 4"), std::string::npos);
  EXPECT_EQ(floor_refusal("fault=stuck&fault_channel=4&extra=1"), "");
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
