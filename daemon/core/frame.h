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
  Overrun = 1,    ///< A buffer for the device's data was full.
  Unplugged = 2,  ///< The device was unplugged.
  Silence = 3,    ///< The device is present but stopped delivering.
  RingFull = 4,   ///< The pipeline was too slow. Only in recordings of dtsd 0.1; later versions report Overrun.
  Integrity = 5,  ///< The device's data failed a check (marker, checksum, counter, time of arrival).
  Stall = 6,      ///< The device halted its data endpoint.
};

inline constexpr std::size_t kGapReasons = 7;

/// Returns one word for logs: "overrun".
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

/// Missing scans before the first scan of a new segment.
struct Gap {
  GapReason reason = GapReason::None;
  std::uint64_t missing_scans = 0;
  bool is_exact = false;  ///< false: the number is estimated from the duration.
};

/// Returns one gap for two gaps: the reason of the later gap, the missing scans of both. Does not count the scans between them.
/// Realtime-safe: yes.
[[nodiscard]] constexpr Gap merged(const Gap& earlier, const Gap& later) noexcept {
  if (earlier.reason == GapReason::None) return later;
  if (later.reason == GapReason::None) return earlier;
  return {
      .reason = later.reason, .missing_scans = earlier.missing_scans + later.missing_scans, .is_exact = earlier.is_exact && later.is_exact};
}

/// One block from the device, as the pipeline receives it.
struct Acquired {
  Block block;
  Gap gap_before{};  ///< Reason None: the block continues the segment.
  std::uint64_t lost_scans_total = 0;
};

/// The pipeline's output for one `Acquired`: one block per stream, in the order of the pipeline's formats. A block with count 0
/// has no values (for example, a window is not full yet).
struct Frame {
  std::vector<Block> streams{};
  Gap gap_before{};
  std::uint32_t segment = 0;
  std::int64_t host_time_ns = 0;
  std::uint64_t lost_scans_total = 0;

  /// Copies everything from `other`, a frame of the same pipeline; does not allocate. Realtime-safe: yes.
  void copy_from(const Frame& other) noexcept {
    for (std::size_t s = 0; s < std::min(streams.size(), other.streams.size()); ++s) streams[s].copy_from(other.streams[s]);
    gap_before = other.gap_before;
    segment = other.segment;
    host_time_ns = other.host_time_ns;
    lost_scans_total = other.lost_scans_total;
  }
};

}  // namespace dts::core
