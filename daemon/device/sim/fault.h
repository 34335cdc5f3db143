// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/rate.h"

namespace dts::device::sim {

enum class FaultKind : std::uint8_t {
  None,
  Unplug,   ///< The device is gone for `for_s`; only once per device object.
  Overrun,  ///< The device loses the scans of `for_s` and knows how many.
  Stuck,    ///< One channel keeps its value for `for_s`.
  Silence,  ///< The device is present but delivers no data for `for_s`.
};

/// A requested fault. Times are in seconds of the device's clock since start.
struct Fault {
  FaultKind kind = FaultKind::None;
  double at_s = 0.0;
  double for_s = 0.0;
  std::size_t channel = 0;  ///< Stuck only.
};

/// The scans of one stream that a fault affects: [first, end). Empty without a fault.
struct FaultWindow {
  static constexpr std::uint64_t kNoScan = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t first = kNoScan;
  std::uint64_t end = kNoScan;

  [[nodiscard]] bool contains(std::uint64_t scan) const noexcept { return scan >= first && scan < end; }
};

/// Returns the window of a fault: at least one scan, or empty without a fault.
[[nodiscard]] FaultWindow fault_window(const Fault& fault, core::Rate rate) noexcept;

}  // namespace dts::device::sim
