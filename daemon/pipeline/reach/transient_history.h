// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "pipeline/reach/state_exchange.h"

namespace dts::pipeline {

/// The last ten seconds of the smoothed transient, by the number of the sample (tick) since the reset.
class TransientHistory {
 public:
  static constexpr std::uint64_t kTicks = 1024;
  static constexpr std::size_t kStateSize = 2 + kTicks;

  void push(double mm) noexcept { values_[++now_ % kTicks] = mm; }
  /// What was before does not count any more: an empty seat, silent sensors, or another movement.
  void forget_before(std::uint64_t tick) noexcept { first_ = std::max(first_, tick); }
  /// The newest; the first has number 1.
  [[nodiscard]] std::uint64_t now() const noexcept { return now_; }
  [[nodiscard]] std::uint64_t oldest() const noexcept { return std::max(first_, now_ < kTicks ? 1 : now_ - kTicks + 1); }
  /// What is not kept any more (or not yet) reads as the nearest that is.
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
