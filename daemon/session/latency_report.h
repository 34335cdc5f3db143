// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dts::session {

/// How long blocks took from the instant of their newest scan to the data socket, since the start. Trivially copyable: it travels in a
/// LatestValue. Realtime-safe: yes.
struct LatencyReport {
  /// A block of 1500 Hz comes every few milliseconds, one of 100 Hz every ten; what takes longer than a second is a hang.
  static constexpr std::array kUpperMs{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0};

  std::array<std::uint64_t, kUpperMs.size() + 1> blocks{};  ///< Per bucket; the last: longer than all bounds.
  double sum_ms = 0.0;

  /// A fitted host time may lie a little ahead: less than nothing counts as nothing.
  void add(double ms) noexcept {
    const double taken_ms = std::max(0.0, ms);
    ++blocks[static_cast<std::size_t>(std::ranges::lower_bound(kUpperMs, taken_ms) - kUpperMs.begin())];
    sum_ms += taken_ms;
  }
};

}  // namespace dts::session
