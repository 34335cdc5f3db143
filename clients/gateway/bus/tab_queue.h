// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/bus/carried.h"

namespace dts::gateway {

/// Messages that wait for one tab. Frames leave at the display's rate while the tab paints them. If it does not, the oldest blocks are
/// dropped first and counted, so that a tab that becomes active again shows the present data.
///
///     push --wanted?--> [blocks and events in order, bounded] --is_due--> take_frame        painted
///
/// Has no clock and no socket: the caller passes the time.
class TabQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// All messages that were dropped because the tab was too slow.
  struct Dropped {
    std::uint64_t blocks = 0;
    std::uint64_t scans = 0;  ///< Scans in those blocks.
    std::uint64_t events = 0;
  };
  static constexpr std::size_t kMostBytes = 512U << 10U;
  static constexpr std::size_t kMostEvents = 256;
  static constexpr std::size_t kMostPrefixes = 32;
  static constexpr std::size_t kLongestPrefix = 200;
  static constexpr std::uint64_t kFramesUnderWay = 2;
  /// Time to collect the messages that the daemon publishes together (all streams of a rig), so that one frame carries them.
  static constexpr std::chrono::milliseconds kGathering{2};

  /// Returns false and changes nothing if there are too many prefixes, a prefix is too long, or the rate is out of range.
  [[nodiscard]] bool subscribe(std::vector<std::string> prefixes, double frames_per_second);
  [[nodiscard]] const std::vector<std::string>& prefixes() const noexcept { return prefixes_; }
  [[nodiscard]] bool wants(std::string_view topic) const noexcept;

  void push(const CarriedPointer& message, Time now);
  /// Returns false if no unpainted frame has this number.
  [[nodiscard]] bool painted(std::uint64_t frame) noexcept;

  /// Returns when the next frame may leave; nothing if no message waits or two frames are not painted yet.
  [[nodiscard]] std::optional<Time> due() const noexcept;
  /// Returns a serialised FromGateway with all waiting messages.
  [[nodiscard]] std::string take_frame(Time now);

  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] const Dropped& dropped() const noexcept { return dropped_; }

 private:
  void shed();
  void drop(std::deque<CarriedPointer>::iterator victim);

  std::vector<std::string> prefixes_;
  std::chrono::nanoseconds spacing_ = std::chrono::nanoseconds(std::chrono::seconds(1)) / 60;
  std::deque<CarriedPointer> waiting_;
  std::size_t bytes_ = 0;
  std::size_t events_ = 0;
  std::uint64_t last_frame_ = 0;
  std::uint64_t last_painted_ = 0;
  Time last_sent_{};
  Time first_pushed_{};  ///< When the oldest waiting message arrived.
  Dropped dropped_;
};

}  // namespace dts::gateway
