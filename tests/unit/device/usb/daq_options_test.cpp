// SPDX-License-Identifier: Apache-2.0
#include "device/usb/daq_options.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "core/block.h"

namespace dts::device::usb {
namespace {

constexpr std::array kRanges = {10.0, 5.0, 2.0, 1.0};
constexpr DaqLimits kLimits{.inputs = 8, .max_scan_length = 8, .must_ascend = true, .ranges_v = kRanges};
constexpr DaqLimits kFree{.inputs = 16, .max_scan_length = 4, .must_ascend = false, .ranges_v = kRanges};

core::Result<DaqOptions> read(const std::string& query, const DaqLimits& limits = kLimits) {
  const DeviceUri uri = *DeviceUri::parse("toy:daq" + query);
  const auto options = UriOptions::read(uri, common_daq_options());
  if (!options) return tl::make_unexpected(options.error());
  return read_daq_options(uri, *options, limits);
}

std::string refusal(const std::string& query, const DaqLimits& limits = kLimits) {
  const auto options = read(query, limits);
  return options ? "" : core::to_string(options.error());
}

using Inputs = std::vector<std::size_t>;

TEST(DaqOptions, Given_Taken) {
  const auto options = read("?serial=01AB&channels=1,3,7&range_v=5,1,2&marker=7&marker_v=-1.5&marker_tolerance_v=0.2");

  ASSERT_TRUE(options.has_value()) << refusal("?serial=01AB&channels=1,3,7&range_v=5,1,2&marker=7&marker_v=-1.5&marker_tolerance_v=0.2");
  EXPECT_EQ(options->serial, "01AB");
  EXPECT_EQ(options->channels, (Inputs{1, 3, 7}));
  EXPECT_EQ(options->ranges_v, (std::vector<double>{5, 1, 2}));
  ASSERT_TRUE(options->marker.has_value());
  EXPECT_EQ(options->marker->position, 2U);
  EXPECT_EQ(options->marker->volts, -1.5);
  EXPECT_EQ(options->marker->tolerance_v, 0.2);
}

TEST(DaqOptions, FreeScanList_AnyOrderUpToItsLength) {
  const auto options = read("?channels=3,1,2&range_v=2", kFree);
  ASSERT_TRUE(options);
  EXPECT_EQ(options->channels, (Inputs{3, 1, 2}));
  EXPECT_EQ(options->ranges_v, (std::vector<double>{2, 2, 2}));
  EXPECT_NE(refusal("?channels=3,1,3", kFree).find("input 3 is listed twice in channels"), std::string::npos);
  const auto too_many = read("?channels=3,1,2,5,4", kFree);
  ASSERT_FALSE(too_many);
  EXPECT_EQ(too_many.error().code, core::ErrorCode::LimitExceeded);
  EXPECT_NE(too_many.error().what.find("at most 4"), std::string::npos) << too_many.error().what;
}

}  // namespace
}  // namespace dts::device::usb
