// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/block.h"

namespace dts::core {

/// Why a segment ended. Values are part of the wire format.
enum class GapReason : std::uint8_t {
  None = 0,
  Overrun = 1,    ///< The device's buffer was full.
  Unplugged = 2,  ///< The device went away.
  Silence = 3,    ///< The device stopped delivering while present.
  RingFull = 4,   ///< The pipeline was too slow; the count is exact.
  Integrity = 5,  ///< The device's data failed a check (marker, checksum, counter, time of arrival).
  Stall = 6,      ///< The device refused to go on: it halted its data endpoint.
};

inline constexpr std::size_t kGapReasons = 7;

/// One word, for logs: "overrun".
[[nodiscard]] constexpr std::string_view name(GapReason reason) noexcept {
  switch (reason) {
    case GapReason::None: return "none";
    case GapReason::Overrun: return "overrun";
    case GapReason::Unplugged: return "unplugged";
    case GapReason::Silence: return "silence";
    case GapReason::RingFull: return "ring_full";
    case GapReason::Integrity: return "integrity";
    case GapReason::Stall: return "stall";
  }
  return "unknown";
}

/// A hole in a rig's data, standing before the first scan of a new segment.
struct Gap {
  GapReason reason = GapReason::None;
  std::uint64_t missing_scans = 0;
  bool is_exact = false;  ///< false: estimated from the duration.
};

/// Returns the hole that two holes make when the scans between them are counted elsewhere: the reason of the later one, the scans of both.
/// Realtime-safe: yes.
[[nodiscard]] constexpr Gap merged(const Gap& earlier, const Gap& later) noexcept {
  if (earlier.reason == GapReason::None) return later;
  if (later.reason == GapReason::None) return earlier;
  return {
      .reason = later.reason, .missing_scans = earlier.missing_scans + later.missing_scans, .is_exact = earlier.is_exact && later.is_exact};
}

/// What the device hands to the pipeline in one go.
struct Acquired {
  Block block;
  Gap gap_before{};  ///< reason None: continues the segment.
  std::uint64_t lost_scans_total = 0;
};

/// What the pipeline makes of it: one block per stream, in the order of the pipeline's formats. A block with count 0
/// says nothing (a window that is not full yet).
struct Frame {
  std::vector<Block> streams{};
  std::uint32_t event_count = 0;  ///< Events that travel with this frame, in a ring of their own (core/event.h).
  Gap gap_before{};
  std::uint32_t segment = 0;
  std::int64_t host_time_ns = 0;
  std::uint64_t lost_scans_total = 0;

  /// Takes everything that `other`, made for the same pipeline, says, into the memory that is there. Realtime-safe: yes.
  void copy_from(const Frame& other) noexcept {
    for (std::size_t s = 0; s < std::min(streams.size(), other.streams.size()); ++s) streams[s].copy_from(other.streams[s]);
    gap_before = other.gap_before;
    segment = other.segment;
    host_time_ns = other.host_time_ns;
    lost_scans_total = other.lost_scans_total;
  }
};

}  // namespace dts::core
