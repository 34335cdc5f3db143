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

/// What waits for one tab. Frames leave at the display's rate while the tab paints them; when it does not, the oldest blocks go first and
/// are counted: a tab that comes back is shown now, not then.
///
///     push --wanted?--> [blocks and events in order, bounded] --is_due--> take_frame        painted
///
/// No clock and no socket: told the time.
class TabQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// What the tab was not shown because it was too slow, in all.
  struct Dropped {
    std::uint64_t blocks = 0;
    std::uint64_t scans = 0;  ///< Of those blocks.
    std::uint64_t events = 0;
  };
  static constexpr std::size_t kMostBytes = 512U << 10U;
  static constexpr std::size_t kMostEvents = 256;
  static constexpr std::size_t kMostPrefixes = 32;
  static constexpr std::size_t kLongestPrefix = 200;
  static constexpr std::uint64_t kFramesUnderWay = 2;
  /// What the daemon publishes together (all streams of a rig) shall leave together.
  static constexpr std::chrono::milliseconds kGathering{2};

  /// False, with nothing changed: too many or too long prefixes, or a rate out of range.
  [[nodiscard]] bool subscribe(std::vector<std::string> prefixes, double frames_per_second);
  [[nodiscard]] const std::vector<std::string>& prefixes() const noexcept { return prefixes_; }
  [[nodiscard]] bool wants(std::string_view topic) const noexcept;

  void push(const CarriedPointer& message, Time now);
  /// False: no frame of that number is under way.
  [[nodiscard]] bool painted(std::uint64_t frame) noexcept;

  /// When a frame may leave: nothing while there is nothing to send or two are under way.
  [[nodiscard]] std::optional<Time> due() const noexcept;
  /// Serialised FromGateway with all that waits.
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
  Time first_pushed_{};  ///< Of what waits.
  Dropped dropped_;
};

}  // namespace dts::gateway
