// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/calibration.h"

#include <bit>
#include <cmath>

namespace dts::device::mcc {
namespace {

// A factory correction is below one hundredth; a converter with a larger error than this is broken.
constexpr double kLargestSlopeError = 0.05;
constexpr double kLargestMiddleError = 1.0 / 64.0;  // part of the full scale: 0.3 V of +-10 V

float read_float(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8U | bytes[i];
  return std::bit_cast<float>(word);
}

}  // namespace

core::Result<Calibration> decode_calibration(std::span<const std::uint8_t> record, unsigned bits, const std::string& where) {
  const auto damaged = [&](const std::string& why) {
    return core::fail(core::ErrorCode::DataDamaged, where + ": " + why,
                      "the unit's calibration memory is blank or damaged: calibrate it again with MCC's InstaCal or at the factory");
  };
  if (record.size() < kCalibrationRecordBytes) return damaged("the record is cut short");
  const Calibration found{.slope = read_float(record), .offset = read_float(record.subspan(4))};
  if (!std::isfinite(found.slope) || !std::isfinite(found.offset)) return damaged("slope or offset is not a number");
  const std::string values = "slope " + std::to_string(found.slope) + ", offset " + std::to_string(found.offset) + " codes";
  if (std::abs(found.slope - 1.0) > kLargestSlopeError) return damaged(values + " is implausible");
  const double full_scale = std::ldexp(1.0, static_cast<int>(bits));
  const double middle = full_scale / 2.0;
  if (std::abs(found.slope * middle + found.offset - middle) > full_scale * kLargestMiddleError) return damaged(values + " is implausible");
  return found;
}

VoltageLine voltage_line(const Calibration& calibration, double range_v, unsigned bits) noexcept {
  const double volts_per_corrected_code = 2.0 * range_v / std::ldexp(1.0, static_cast<int>(bits));
  return {.volts_per_code = calibration.slope * volts_per_corrected_code,
          .volts_at_zero = calibration.offset * volts_per_corrected_code - range_v};
}

}  // namespace dts::device::mcc
