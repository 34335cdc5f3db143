// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/reach.h"
#include "core/sway.h"

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

/// The trigger channel crossed its level between the scan before and this one.
struct TriggerEvent {
  std::uint32_t segment = 0;
  ScanIndex scan;
  std::int64_t host_time_ns = 0;
  bool is_rising = true;
};

/// The events of one kind in one frame; of more than there is room for the rest is counted only.
template <class Event, std::size_t kCapacity>
struct BoundedEvents {
  std::array<Event, kCapacity> events{};
  std::size_t count = 0;
  std::uint64_t lost = 0;  ///< Found no room.

  void push(const Event& event) noexcept {
    if (count < events.size()) {
      events[count++] = event;
    } else {
      ++lost;
    }
  }
  void clear() noexcept {
    count = 0;
    lost = 0;
  }
  /// Those of `earlier` before these.
  void prepend(const BoundedEvents& earlier) noexcept {
    BoundedEvents all = earlier;
    all.lost += lost;
    for (const Event& event : all_of()) all.push(event);
    *this = all;
  }
  [[nodiscard]] std::span<const Event> all_of() const noexcept { return std::span(events).first(count); }
};

inline constexpr std::size_t kMaxTriggersPerFrame = 16;
inline constexpr std::size_t kMaxReachesPerFrame = 8;
inline constexpr std::size_t kMaxSwaysPerFrame = 2;  // told twice a second

using TriggerEvents = BoundedEvents<TriggerEvent, kMaxTriggersPerFrame>;

/// What the pipeline noticed while it made one frame.
struct FrameEvents {
  TriggerEvents triggers{};
  BoundedEvents<ReachEvent, kMaxReachesPerFrame> reaches{};
  BoundedEvents<ClassEvent, kMaxReachesPerFrame> classes{};
  BoundedEvents<SwayEvent, kMaxSwaysPerFrame> sways{};  ///< Preliminary: of those that find no room the next says more.

  [[nodiscard]] std::uint64_t lost() const noexcept { return triggers.lost + reaches.lost + classes.lost; }
  [[nodiscard]] bool empty() const noexcept { return triggers.count + reaches.count + classes.count + sways.count == 0; }
  void clear() noexcept {
    triggers.clear();
    reaches.clear();
    classes.clear();
    sways.clear();
  }
  void prepend(const FrameEvents& earlier) noexcept {
    triggers.prepend(earlier.triggers);
    reaches.prepend(earlier.reaches);
    classes.prepend(earlier.classes);
    sways.prepend(earlier.sways);
  }
};

/// What the pipeline makes of it: one block per stream, in the order of the pipeline's formats. A block with count 0
/// says nothing (a window that is not full yet).
struct Frame {
  std::vector<Block> streams{};
  FrameEvents events{};
  Gap gap_before{};
  std::uint32_t segment = 0;
  std::int64_t host_time_ns = 0;
  std::uint64_t lost_scans_total = 0;

  /// Takes everything that `other`, made for the same pipeline, says, into the memory that is there. Realtime-safe: yes.
  void copy_from(const Frame& other) noexcept {
    for (std::size_t s = 0; s < std::min(streams.size(), other.streams.size()); ++s) streams[s].copy_from(other.streams[s]);
    events = other.events;
    gap_before = other.gap_before;
    segment = other.segment;
    host_time_ns = other.host_time_ns;
    lost_scans_total = other.lost_scans_total;
  }
};

}  // namespace dts::core
