// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "session/recent_peak.h"

namespace dts::session {

/// Histogram of block latency since the start, from the time of the newest scan to the data socket. Trivially copyable, as LatestValue
/// requires. Realtime-safe: yes.
struct LatencyReport {
  /// A block at 1500 Hz is due every few milliseconds, a block at 100 Hz every 10 ms; more than 1 s means that something hangs.
  static constexpr std::array kUpperMs{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0};

  std::array<std::uint64_t, kUpperMs.size() + 1> blocks{};  ///< Per bucket; the last counts everything above all bounds.
  double sum_ms = 0.0;

  /// Counts a negative latency as 0: a fitted host time may lie slightly in the future.
  void add(double ms) noexcept {
    const double taken_ms = std::max(0.0, ms);
    ++blocks[static_cast<std::size_t>(std::ranges::lower_bound(kUpperMs, taken_ms) - kUpperMs.begin())];
    sum_ms += taken_ms;
  }
};

/// The publisher's report about the frames of one rig. Trivially copyable, as LatestValue requires.
struct PublishReport {
  LatencyReport latency{};
  RecentPeak frames_waiting{};    ///< Frames that waited for the publisher.
  std::uint64_t lost_frames = 0;  ///< Frames that the publisher skipped because it was too slow.
  std::uint64_t lost_events = 0;  ///< Events of these frames, and events that found no room.
};

}  // namespace dts::session
