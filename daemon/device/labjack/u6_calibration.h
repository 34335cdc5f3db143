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
inline constexpr std::size_t kCalibrationBlocks = 4;       ///< Those of the converter that streams; the rest is for others.
inline constexpr std::size_t kCalibrationBlockBytes = 32;  ///< Four numbers.

/// Signed 32.32 fixed point, little-endian.
[[nodiscard]] double fixed_point(std::span<const std::uint8_t, 8> bytes) noexcept;

/// Codes to volts by the unit's own constants (U6 data sheet, section 5.4): two slopes that meet at the centre, which is 0 V.
///
///     v = (code - centre) * positive slope   at and above the centre
///     v = (centre - code) * negative slope   below; that slope is a negative number
class Calibration {
 public:
  struct Gain {
    double positive_slope_v = 0.0;
    double negative_slope_v = 0.0;
    double center = 0.0;
  };

  /// What a unit without constants would have: for describing one that is not there.
  [[nodiscard]] static Calibration nominal() noexcept;
  /// From blocks 0 to 3 in a row. DataDamaged: a constant of a gain in use is not a number or further from nominal than any
  /// converter that works.
  [[nodiscard]] static core::Result<Calibration> parse(std::span<const std::uint8_t> blocks, std::span<const std::size_t> gains_in_use);

  /// Realtime-safe: yes. `gain` < 4.
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
