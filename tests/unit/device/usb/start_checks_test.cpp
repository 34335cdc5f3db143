// SPDX-License-Identifier: Apache-2.0
#include "device/usb/start_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace dts::device::usb {
namespace {

const std::vector<double> kSingle = {0.5, 1.0, 2.0, 4.0};

std::vector<double> rotated(std::vector<double> values, std::size_t by) {
  std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(by), values.end());
  return values;
}

TEST(StartChecks, EveryRotation_Found) {
  RecordProperty("requirement", "ACQ-6");
  for (std::size_t by = 1; by < kSingle.size(); ++by) {
    std::vector<double> scan = rotated(kSingle, by);
    for (double& volts : scan) volts += 0.05;

    const Agreement agreement = compare_with_single_readings(kSingle, scan);

    EXPECT_TRUE(agreement.is_rotated) << by;
    EXPECT_EQ(agreement.rotation, kSingle.size() - by);
  }
}

TEST(StartChecks, SomebodyMoves_DifferentButNotRotated) {
  for (const auto& scan :
       {std::vector<double>{1.4, 1.0, 2.0, 4.0}, std::vector<double>{0.9, 1.5, 1.4, 3.0}, std::vector<double>{2, 2, 2, 2}}) {
    const Agreement agreement = compare_with_single_readings(kSingle, scan);
    EXPECT_TRUE(agreement.is_different);
    EXPECT_FALSE(agreement.is_rotated);
  }
}

TEST(StartChecks, ChannelsThatLookAlikeOneOrNoneOrNotANumber_NoRotation) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(compare_with_single_readings({{1.0, 1.01, 1.0, 0.99}}, {{1.01, 1.0, 0.99, 1.0}}).is_rotated);
  EXPECT_FALSE(compare_with_single_readings({{1.0}}, {{3.0}}).is_rotated);
  EXPECT_FALSE(compare_with_single_readings({}, {}).is_rotated);
  EXPECT_FALSE(compare_with_single_readings(kSingle, {{1.0, 2.0, 4.0}}).is_rotated);
  EXPECT_FALSE(compare_with_single_readings({{nan, 1.0, 2.0, 4.0}}, {{4.0, nan, 1.0, 2.0}}).is_rotated);
}

TEST(StartChecks, Report_SaysWhichChannel) {
  DeviceDescription description;
  for (const char* name : {"a", "b", "c", "d"}) description.channels.push_back({.name = name, .unit = "V"});

  const DeviceCheck fine = describe_agreement(compare_with_single_readings(kSingle, {{0.5, 1.003, 2.0, 4.0}}), description);
  const DeviceCheck moved = describe_agreement(compare_with_single_readings(kSingle, {{0.5, 1.0, 2.0, 4.4}}), description);
  const DeviceCheck bad = describe_agreement(compare_with_single_readings(kSingle, rotated(kSingle, 1)), description);

  EXPECT_EQ(fine.outcome, DeviceCheck::Outcome::Passed);
  EXPECT_EQ(fine.detail, "largest difference 3 mV on b");

  EXPECT_EQ(moved.outcome, DeviceCheck::Outcome::Warning);
  EXPECT_NE(moved.detail.find("400 mV on d"), std::string::npos);
  EXPECT_EQ(bad.outcome, DeviceCheck::Outcome::Failed);
  EXPECT_NE(bad.detail.find("rotated by 3"), std::string::npos);
}

}  // namespace
}  // namespace dts::device::usb
