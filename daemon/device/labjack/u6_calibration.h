// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"

namespace dts::device::labjack {

/// Ranges by gain index: amplification 1, 10, 100, 1000.
inline constexpr std::array<double, 4> kRangesV = {10.0, 1.0, 0.1, 0.01};
inline constexpr std::size_t kCalibrationBlocks = 4;       ///< Blocks of the streaming converter; the other blocks belong to other parts.
inline constexpr std::size_t kCalibrationBlockBytes = 32;  ///< Four numbers.

/// Decodes signed 32.32 fixed point, little-endian.
[[nodiscard]] double fixed_point(std::span<const std::uint8_t, 8> bytes) noexcept;

/// Converts codes to volts with the unit's constants (U6 data sheet, section 5.4): two slopes that meet at the centre, which is 0 V.
///
///     v = (code - centre) * positive slope   at and above the centre
///     v = (centre - code) * negative slope   below the centre; this slope is a negative number
class Calibration {
 public:
  struct Gain {
    double positive_slope_v = 0.0;
    double negative_slope_v = 0.0;
    double center = 0.0;
  };

  /// Returns the nominal constants, to describe a unit that is not present.
  [[nodiscard]] static Calibration nominal() noexcept;
  /// Reads the constants from blocks 0 to 3, concatenated. Fails with DataDamaged if a constant of a used gain is not a number, or is
  /// farther from nominal than in any working converter.
  [[nodiscard]] static core::Result<Calibration> parse(std::span<const std::uint8_t> blocks, std::span<const std::size_t> gains_in_use);

  /// Converts a code to volts; `gain` < 4. Realtime-safe: yes.
  [[nodiscard]] double volts(std::size_t gain, std::uint16_t code) const noexcept {
    const Gain& constants = gains_[gain];
    const double above = static_cast<double>(code) - constants.center;
    return above >= 0.0 ? above * constants.positive_slope_v : -above * constants.negative_slope_v;
  }
  [[nodiscard]] const Gain& gain(std::size_t index) const noexcept { return gains_[index]; }

 private:
  std::array<Gain, kRangesV.size()> gains_{};
};

}  // namespace dts::device::labjack
