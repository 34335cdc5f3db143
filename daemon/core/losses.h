// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/frame.h"

namespace dts::core {

/// Gaps, and the scans that are missing in them.
struct LossCount {
  std::uint64_t gaps = 0;
  std::uint64_t scans = 0;  ///< Of a gap whose length is not known exactly: by the time between the scans around it.

  friend bool operator==(const LossCount&, const LossCount&) = default;
};

/// What was lost, by reason; under `GapReason::None` what nobody gave a reason for. Trivially copyable.
class Losses {
 public:
  /// Counts that do not fit stay at the largest that does. Realtime-safe: yes.
  void add(GapReason reason, LossCount more) noexcept;
  [[nodiscard]] const LossCount& of(GapReason reason) const noexcept { return by_reason_[static_cast<std::size_t>(reason) % kGapReasons]; }
  [[nodiscard]] LossCount total() const noexcept;

  friend bool operator==(const Losses&, const Losses&) = default;

 private:
  std::array<LossCount, kGapReasons> by_reason_{};
};

/// "10560 scans lost in 2 gaps: ring_full 1, silence 1"; empty when there is no gap.
[[nodiscard]] std::string to_text(const Losses& losses);

}  // namespace dts::core
