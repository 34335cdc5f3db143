// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_calibration.h"

#include <algorithm>
#include <string>

namespace dts::device::labjack {
namespace {

// Values of Exodriver's example for units without constants. An amplifier with a larger error than the tolerances is broken.
constexpr double kNominalSlopeV = 3.1580578e-4;
constexpr double kNominalCenter = 33523.0;
constexpr double kSlopeTolerance = 0.05;
constexpr double kCenterTolerance = 1000.0;  // 0.3 V of +-10 V

bool is_near(double value, double nominal, double tolerance) noexcept { return std::abs(value - nominal) <= tolerance; }

}  // namespace

double fixed_point(std::span<const std::uint8_t, 8> bytes) noexcept {
  std::uint64_t word = 0;
  for (std::size_t i = 8; i-- > 0;) word = word << 8U | bytes[i];
  const auto whole = static_cast<std::int32_t>(static_cast<std::uint32_t>(word >> 32U));
  return static_cast<double>(whole) + static_cast<double>(word & 0xFFFF'FFFFU) / 4294967296.0;
}

Calibration Calibration::nominal() noexcept {
  Calibration result;
  for (std::size_t gain = 0; gain < kRangesV.size(); ++gain) {
    const double slope_v = kNominalSlopeV * kRangesV[gain] / kRangesV[0];
    result.gains_[gain] = {slope_v, -slope_v, kNominalCenter};
  }
  return result;
}

core::Result<Calibration> Calibration::parse(std::span<const std::uint8_t> blocks, std::span<const std::size_t> gains_in_use) {
  if (blocks.size() != kCalibrationBlocks * kCalibrationBlockBytes) {
    return core::fail(core::ErrorCode::DataDamaged, "LabJack U6: " + std::to_string(blocks.size()) + " bytes of calibration");
  }
  // Blocks 0 and 1: positive slope and offset of each gain; 2 and 3: negative slope and centre of each gain.
  const auto number = [&](std::size_t index) { return fixed_point(blocks.subspan(8 * index).first<8>()); };
  Calibration result;
  for (std::size_t gain = 0; gain < kRangesV.size(); ++gain) {
    result.gains_[gain] = {number(2 * gain), number(8 + 2 * gain), number(9 + 2 * gain)};
  }
  const Calibration expected = nominal();
  for (const std::size_t gain : gains_in_use) {
    const Gain& found = result.gains_[gain];
    const double slope_v = expected.gains_[gain].positive_slope_v;
    const bool is_believable = is_near(found.positive_slope_v, slope_v, kSlopeTolerance * slope_v) &&
                               is_near(found.negative_slope_v, -slope_v, kSlopeTolerance * slope_v) &&
                               is_near(found.center, kNominalCenter, kCenterTolerance);
    if (is_believable) continue;
    return core::fail(core::ErrorCode::DataDamaged,
                      "LabJack U6: the calibration of the range +-" + std::to_string(kRangesV[gain]) + " V is implausible: slopes " +
                          std::to_string(found.positive_slope_v * 1e6) + " and " + std::to_string(found.negative_slope_v * 1e6) +
                          " uV, centre " + std::to_string(found.center),
                      "compare with another program; restore the constants with the vendor's tools");
  }
  return result;
}

}  // namespace dts::device::labjack
