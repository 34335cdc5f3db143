// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/result.h"

namespace dts::device::mcc {

/// Factory calibration of one input: corrected code = code * slope + offset (uldaq: src/utility/EuScale.cpp).
struct Calibration {
  double slope = 1.0;
  double offset = 0.0;
};

inline constexpr std::size_t kCalibrationRecordBytes = 8;  ///< float32 slope, float32 offset, little endian.

/// Decodes one record of the device's memory. Fails with DataDamaged if it is too short, not a number or not plausible; the error
/// contains `where`.
[[nodiscard]] core::Result<Calibration> decode_calibration(std::span<const std::uint8_t> record, unsigned bits, const std::string& where);

/// Converts codes to volts with one multiplication and one addition, without rounding or clamping.
struct VoltageLine {
  double volts_per_code = 0.0;
  double volts_at_zero = 0.0;

  [[nodiscard]] double at(std::uint16_t code) const noexcept { return code * volts_per_code + volts_at_zero; }
};

/// Returns the line of an input with range +-`range_v` and offset binary codes of `bits` bits.
[[nodiscard]] VoltageLine voltage_line(const Calibration& calibration, double range_v, unsigned bits) noexcept;

}  // namespace dts::device::mcc
