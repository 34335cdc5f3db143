// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/rate.h"

namespace dts::device::sim {

enum class FaultKind : std::uint8_t {
  None,
  Unplug,   ///< The device is gone for `for_s`, once in the life of the device object.
  Overrun,  ///< The device loses the scans of `for_s` and knows how many.
  Stuck,    ///< One channel keeps its code for `for_s`.
  Silence,  ///< Present, but no data for `for_s`.
};

/// A fault that a test or a demonstration asked for, in seconds of the device since start.
struct Fault {
  FaultKind kind = FaultKind::None;
  double at_s = 0.0;
  double for_s = 0.0;
  std::size_t channel = 0;  ///< Stuck only.
};

/// The scans of one stream that a fault touches: [first, end). Empty for no fault.
struct FaultWindow {
  static constexpr std::uint64_t kNoScan = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t first = kNoScan;
  std::uint64_t end = kNoScan;

  [[nodiscard]] bool contains(std::uint64_t scan) const noexcept { return scan >= first && scan < end; }
};

/// At least one scan long unless there is no fault.
[[nodiscard]] FaultWindow fault_window(const Fault& fault, core::Rate rate) noexcept;

}  // namespace dts::device::sim
