// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_calibration.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace dts::device::labjack {
namespace {

constexpr std::array<std::size_t, 4> kAllGains = {0, 1, 2, 3};

std::vector<std::uint8_t> blocks_of(const std::array<double, 16>& numbers) {
  std::vector<std::uint8_t> bytes;
  for (const double number : numbers) {
    const auto fixed = static_cast<std::uint64_t>(std::llround(number * 4294967296.0));
    for (unsigned byte = 0; byte < 8; ++byte) bytes.push_back(static_cast<std::uint8_t>(fixed >> (8U * byte)));
  }
  return bytes;
}

std::array<double, 16> sound_numbers() {
  return {3.16e-4,  -10.6, 3.15e-5,  -1.06, 3.17e-6,  -0.106, 3.14e-7,  -0.0106,
          -3.15e-4, 33500, -3.16e-5, 33510, -3.14e-6, 33520,  -3.17e-7, 33530};
}

TEST(U6Calibration, FixedPoint_SignedWithFraction) {
  EXPECT_EQ(fixed_point(std::array<std::uint8_t, 8>{0, 0, 0, 0x80, 0x02, 0, 0, 0}), 2.5);
  EXPECT_EQ(fixed_point(std::array<std::uint8_t, 8>{0, 0, 0, 0x40, 0xFF, 0xFF, 0xFF, 0xFF}), -0.75);
  // Near the nominal slope of the 10 V range: 0x14B258 = 1356376
  EXPECT_EQ(fixed_point(std::array<std::uint8_t, 8>{0x58, 0xB2, 0x14, 0, 0, 0, 0, 0}), 1356376.0 / 4294967296.0);
}

TEST(U6Calibration, Volts_TwoSlopesMeetAtTheCentre) {
  const auto calibration = Calibration::parse(blocks_of(sound_numbers()), kAllGains);
  ASSERT_TRUE(calibration.has_value());
  EXPECT_NEAR(calibration->volts(0, 33500), 0.0, 1e-9);
  EXPECT_NEAR(calibration->volts(0, 43500), 3.16, 1e-5);
  EXPECT_NEAR(calibration->volts(0, 23500), -3.15, 1e-5);
  EXPECT_NEAR(calibration->volts(1, 43510), 0.315, 1e-5);
  EXPECT_NEAR(calibration->volts(2, 23520), -0.0314, 3e-6);
  EXPECT_NEAR(calibration->volts(3, 43530), 0.00314, 3e-6);
}

TEST(U6Calibration, EachConstantFarOff_IsNotBelieved) {
  for (const std::size_t at : {0U, 2U, 4U, 6U, 8U, 9U, 10U, 11U, 12U, 13U, 14U, 15U}) {
    auto numbers = sound_numbers();
    numbers[at] *= 1.1;
    const auto calibration = Calibration::parse(blocks_of(numbers), kAllGains);
    ASSERT_FALSE(calibration.has_value()) << at;
    EXPECT_EQ(calibration.error().code, core::ErrorCode::DataDamaged);
  }
}

TEST(U6Calibration, ErasedOrEmptyMemory_IsNotBelieved) {
  EXPECT_FALSE(Calibration::parse(std::vector<std::uint8_t>(128, 0xFF), kAllGains).has_value());
  EXPECT_FALSE(Calibration::parse(std::vector<std::uint8_t>(128, 0x00), kAllGains).has_value());
  EXPECT_FALSE(Calibration::parse(std::vector<std::uint8_t>(127, 0x00), kAllGains).has_value());
}

TEST(U6Calibration, GainNotInUse_MayBeDamaged) {
  auto numbers = sound_numbers();
  numbers[6] = 0.0;
  EXPECT_TRUE(Calibration::parse(blocks_of(numbers), std::array<std::size_t, 2>{0, 1}).has_value());
  EXPECT_FALSE(Calibration::parse(blocks_of(numbers), std::array<std::size_t, 2>{0, 3}).has_value());
}

}  // namespace
}  // namespace dts::device::labjack
