// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "core/broadcast_ring.h"
#include "core/event.h"
#include "core/frame.h"

namespace dts::core {

/// A place between two frames, counted since the start of the rig. Trivially copyable, for the reports of the rig thread.
struct FramePosition {
  std::uint64_t frame = 0;             ///< Number of frames before it,
  std::uint64_t scans = 0;             ///< of their scans,
  std::uint64_t events = 0;            ///< and of their events.
  std::uint64_t lost_events = 0;       ///< Events that found no room in their frame (FrameEvents).
  std::uint64_t lost_scans_total = 0;  ///< Scans that the device lost before it.
  std::uint32_t segment = 0;           ///< Segment of the newest frame before it.
};

/// The newest frames of a rig, with their events: one ring for all who follow them. Each of them has a FrameReader.
///
///     rig thread: write --> [ frames ][ events ] --> FrameReader of the publisher, the recorder, the session
///
/// A frame is stored as words, only as many scans as it has. Its events are in a ring of their own, since they are rare: room for them in
/// every frame would need 2.9 kB.
class FrameRing {
 public:
  /// A ring never becomes larger: at high rates it then holds a shorter time.
  static constexpr std::size_t kMostBytes = std::size_t{36} << 20U;
  /// Enough for 250 events a second while a ring of 8 s lasts.
  static constexpr std::size_t kEvents = 2048;

  /// Makes room for `frames` frames of the size of `prototype`, limited by `kMostBytes`. `is_short`, for each stream: its values are stored
  /// as float32, in half of the memory. Thread: control.
  FrameRing(std::size_t frames, const Frame& prototype, std::vector<bool> is_short);

  /// Writes a frame like the prototype, and its events. Thread: rig. Realtime-safe: yes.
  void write(const Frame& frame, const FrameEvents& events) noexcept;
  /// Returns the place after the newest frame. Thread: rig.
  [[nodiscard]] const FramePosition& end() const noexcept { return end_; }

  /// Returns how many frames have been written. Thread: any.
  [[nodiscard]] std::uint64_t written() const noexcept { return frames_.written(); }
  [[nodiscard]] std::size_t capacity() const noexcept { return frames_.capacity(); }

 private:
  friend class FrameReader;
  using Word = BroadcastRing<>::Word;

  std::vector<bool> is_short_;
  BroadcastRing<> frames_;
  BroadcastRing<> events_;
  Frame prototype_;
  std::vector<Word> words_;  ///< The frame that is being written.
  FramePosition end_;
  Gap segment_gap_;  ///< The gap before the current segment.
};

/// Reads the frames of a ring, each once, in order. A reader that is too late continues with newer frames and knows exactly what it lost.
/// Thread: one at a time.
class FrameReader {
 public:
  /// Reads from the beginning. Skips frames when more than `longest_lag` wait, or more than the ring holds. `ring` outlives the reader.
  FrameReader(const FrameRing& ring, std::size_t longest_lag);

  /// Continues at `position`, and counts losses from 0.
  void start_at(const FramePosition& position) noexcept;

  /// Returns a copy of the oldest frame, valid until `release`, or nullptr if no frame waits. After a loss, the frame has the gap that
  /// would be before it in one piece: the last reason, all missing scans of the device. Realtime-safe: yes.
  [[nodiscard]] const Frame* front() noexcept;
  /// Returns the events of the frame that `front` returned. Realtime-safe: yes.
  [[nodiscard]] std::span<const Event> events() const noexcept { return std::span(events_).first(event_count_); }
  /// Continues with the next frame. Only after `front` returned one. Realtime-safe: yes.
  void release() noexcept;

  /// Returns the place before the frame that `front` returns, or the end of what was read.
  [[nodiscard]] const FramePosition& position() const noexcept { return position_; }
  /// Returns the number of frames that wait.
  [[nodiscard]] std::size_t waiting() const noexcept { return static_cast<std::size_t>(ring_.written() - position_.frame); }
  /// Return what this reader missed since the beginning or `start_at`: frames and scans; events, those included that found no room.
  [[nodiscard]] std::uint64_t lost_frames() const noexcept { return lost_frames_; }
  [[nodiscard]] std::uint64_t lost_scans() const noexcept { return lost_scans_; }
  [[nodiscard]] std::uint64_t lost_events() const noexcept { return lost_events_; }

 private:
  static constexpr std::size_t kMostEvents = kMaxTriggersPerFrame + 2 * kMaxReachesPerFrame + kMaxSwaysPerFrame;

  [[nodiscard]] bool read_front() noexcept;
  void read_events(const FramePosition& end) noexcept;

  const FrameRing& ring_;
  std::size_t longest_lag_;
  FramePosition position_;
  FramePosition next_;  ///< The place after the frame that `front` returned.
  std::uint64_t lost_frames_ = 0;
  std::uint64_t lost_scans_ = 0;
  std::uint64_t lost_events_ = 0;
  bool has_front_ = false;
  std::vector<FrameRing::Word> words_;
  Frame frame_;
  std::array<Event, kMostEvents> events_{};
  std::size_t event_count_ = 0;
};

}  // namespace dts::core
