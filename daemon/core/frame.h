// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  RingFull = 4,   ///< The recorder was later than the ring of frames is long; the number of missing scans is exact.
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
};

}  // namespace dts::core
