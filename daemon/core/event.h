// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "core/block.h"
#include "core/reach.h"
#include "core/sway.h"

namespace dts::core {

/// The trigger channel crossed its level between the previous scan and this scan.
struct TriggerEvent {
  std::uint32_t segment = 0;
  ScanIndex scan;
  std::int64_t host_time_ns = 0;
  bool is_rising = true;
};

/// The events of one kind in one frame. If full, new events are dropped and counted.
template <class Kind, std::size_t kCapacity>
struct BoundedEvents {
  std::array<Kind, kCapacity> events{};
  std::size_t count = 0;
  std::uint64_t lost = 0;  ///< Number of dropped events.

  void push(const Kind& event) noexcept {
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
  [[nodiscard]] std::span<const Kind> all_of() const noexcept { return std::span(events).first(count); }
};

inline constexpr std::size_t kMaxTriggersPerFrame = 16;
inline constexpr std::size_t kMaxReachesPerFrame = 8;
inline constexpr std::size_t kMaxSwaysPerFrame = 2;  // the stage `steadiness` publishes two per second

using TriggerEvents = BoundedEvents<TriggerEvent, kMaxTriggersPerFrame>;

/// The events that the pipeline found while it made one frame.
struct FrameEvents {
  TriggerEvents triggers{};
  BoundedEvents<ReachEvent, kMaxReachesPerFrame> reaches{};
  BoundedEvents<ClassEvent, kMaxReachesPerFrame> classes{};
  BoundedEvents<SwayEvent, kMaxSwaysPerFrame> sways{};  ///< Preliminary: if full, drop; the next value supersedes it.

  [[nodiscard]] std::uint64_t lost() const noexcept { return triggers.lost + reaches.lost + classes.lost; }
  void clear() noexcept {
    triggers.clear();
    reaches.clear();
    classes.clear();
    sways.clear();
  }
};

/// An event of any kind.
using Event = std::variant<TriggerEvent, ReachEvent, ClassEvent, SwayEvent>;

/// Calls `use` with every event in the order of publication: triggers; then reaches, each class right after the Final of its
/// reach; then sway.
template <class Use>
void for_each(const FrameEvents& events, Use use) {
  for (const TriggerEvent& trigger : events.triggers.all_of()) use(Event(trigger));
  const auto classes = events.classes.all_of();
  auto next = classes.begin();
  for (const ReachEvent& reach : events.reaches.all_of()) {
    while (next != classes.end() && next->scan < reach.scan) use(Event(*next++));
    use(Event(reach));
    const bool is_next = next != classes.end() && next->number == reach.number && next->scan == reach.scan;
    if (is_next && reach.step == ReachStep::Final) use(Event(*next++));
  }
  while (next != classes.end()) use(Event(*next++));
  for (const SwayEvent& sway : events.sways.all_of()) use(Event(sway));
}

}  // namespace dts::core
