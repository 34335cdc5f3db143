// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/frame.h"

namespace dts::core {

/// Number of gaps and of scans missing in them.
struct LossCount {
  std::uint64_t gaps = 0;
  std::uint64_t scans = 0;  ///< For a gap of unknown length, estimated from the time between the scans around it.

  friend bool operator==(const LossCount&, const LossCount&) = default;
};

/// Losses by reason; `GapReason::None` counts losses of unknown reason. Trivially copyable.
class Losses {
 public:
  /// Adds to the counts of `reason`; they saturate at the largest value. Realtime-safe: yes.
  void add(GapReason reason, LossCount more) noexcept;
  [[nodiscard]] const LossCount& of(GapReason reason) const noexcept { return by_reason_[static_cast<std::size_t>(reason) % kGapReasons]; }
  [[nodiscard]] LossCount total() const noexcept;

  friend bool operator==(const Losses&, const Losses&) = default;

 private:
  std::array<LossCount, kGapReasons> by_reason_{};
};

/// Returns a text such as "10560 scans lost in 2 gaps: ring_full 1, silence 1"; empty without gaps.
[[nodiscard]] std::string to_text(const Losses& losses);

}  // namespace dts::core
