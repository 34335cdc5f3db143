// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "pipeline/reach/state_exchange.h"

namespace dts::pipeline {

/// The last 10 s of the smoothed transient, by sample number (tick) since the reset.
class TransientHistory {
 public:
  static constexpr std::uint64_t kTicks = 1024;
  static constexpr std::size_t kStateSize = 2 + kTicks;

  void push(double mm) noexcept { values_[++now_ % kTicks] = mm; }
  /// Ignores everything before `tick`: an empty seat, invalid sensor values, or another movement.
  void forget_before(std::uint64_t tick) noexcept { first_ = std::max(first_, tick); }
  /// Returns the newest tick; the first sample has tick 1.
  [[nodiscard]] std::uint64_t now() const noexcept { return now_; }
  [[nodiscard]] std::uint64_t oldest() const noexcept { return std::max(first_, now_ < kTicks ? 1 : now_ - kTicks + 1); }
  /// Returns the value at `tick`; for a tick outside the kept range, the value at the nearest kept tick.
  [[nodiscard]] double at(std::uint64_t tick) const noexcept {
    return values_[std::clamp(tick, oldest(), std::max(now_, oldest())) % kTicks];
  }
  void reset() noexcept {
    values_ = {};
    now_ = 0;
    first_ = 1;
  }
  template <class Self, class Archive>
  static void exchange(Self& self, Archive& archive) noexcept {
    archive.count(self.now_, std::uint64_t{1} << 52U);
    archive.count(self.first_, std::uint64_t{1} << 52U);
    for (auto& value : self.values_) archive.number(value, -kMostStateMm, kMostStateMm);
  }

 private:
  std::array<double, kTicks> values_{};
  std::uint64_t now_ = 0;
  std::uint64_t first_ = 1;
};

}  // namespace dts::pipeline
