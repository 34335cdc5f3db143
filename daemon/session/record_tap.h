// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/event.h"
#include "core/frame.h"
#include "core/spsc_ring.h"
#include "pipeline/pipeline.h"

namespace dts::session {

/// Where a rig's frames branch off to the recorder: a ring of seconds between the pipeline thread and the record thread.
///
///     control:   open() -> take 3                        close()
///     pipeline:            [save state] frame frame frame ...  frame  end
///     record:                           take 3: state, then frames, until the end mark
///
/// A take is one recording. The state of the stages is saved just before its first frame, so that a replay can start from there. A frame
/// that finds the ring full is dropped; every later slot of the take says how many scans were lost so, the end mark too: also a loss that
/// no later scan index shows (at the end, or before a new segment) makes the recording incomplete.
class RecordTap {
 public:
  struct Slot {
    core::Frame frame;
    std::uint64_t take = 0;
    bool is_end = false;            ///< No frame: the take is over.
    std::uint64_t lost_scans = 0;   ///< Of the take, that found no room before this slot.
    std::uint64_t lost_events = 0;  ///< The same, of frames that found room.
  };

  RecordTap(std::size_t slots, const pipeline::Pipeline& pipeline);

  /// Number of the take that `open` will begin. Thread: control.
  [[nodiscard]] std::uint64_t next_take() const noexcept { return takes_ + 1; }
  /// Begins a take. The one before must have been closed and read to its end. Thread: control.
  void open() noexcept { opened_.store(++takes_, std::memory_order_release); }  // pairs with follow()
  /// Ends it: an end mark follows its last frame, also when the pipeline thread has not seen it begin. Thread: control.
  void close() noexcept { closed_.store(takes_, std::memory_order_release); }  // pairs with follow()

  /// Does what `open` and `close` asked for. Call it before every frame, and now and then while there is none.
  /// Thread: pipeline. Realtime-safe: yes.
  void follow() noexcept;
  /// A take is under way and there is no room for a frame. Thread: pipeline. Realtime-safe: yes.
  [[nodiscard]] bool is_blocked() noexcept { return current_ != 0 && ring_.claim() == nullptr; }
  /// Copies a frame with its events for the recorder if a take is under way. The events of a frame
  /// that is dropped are dropped with it: a replay could not find them. Thread: pipeline. Realtime-safe: yes.
  void offer(const core::Frame& frame, const core::FrameEvents& events = {}) noexcept;

  /// Events of the slots (`Frame::event_count`). Thread: record.
  [[nodiscard]] core::EventLane& events() noexcept { return events_; }
  /// The oldest slot, or nullptr; give it back with `release`. Thread: record.
  [[nodiscard]] const Slot* front() noexcept { return ring_.front(); }
  void release() noexcept { ring_.release(); }
  /// State of the stages before the first frame of the take. Thread: record, once that frame was seen.
  [[nodiscard]] std::span<const double> state() const noexcept { return state_; }
  /// Frames that found no room, ever. Thread: any.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return ring_.dropped(); }
  /// Slots that wait for the recorder. Thread: any.
  [[nodiscard]] std::size_t waiting() const noexcept { return ring_.waiting(); }
  /// Slots in all. Thread: any.
  [[nodiscard]] std::size_t capacity() const noexcept { return ring_.capacity(); }

 private:
  [[nodiscard]] bool end_closed() noexcept;

  const pipeline::Pipeline& pipeline_;
  core::SpscRing<Slot> ring_;
  core::EventLane events_;
  std::vector<double> state_;  ///< Written by the pipeline thread before the take's first commit, which the record thread sees first.
  std::atomic<std::uint64_t> opened_{0};  ///< Newest take that was begun.
  std::atomic<std::uint64_t> closed_{0};  ///< Newest take that was ended.
  std::uint64_t takes_ = 0;               ///< Control's.
  std::uint64_t current_ = 0;             ///< The pipeline thread's; 0: none.
  std::uint64_t begun_ = 0;               ///< The same; the newest that was current.
  std::uint64_t lost_scans_ = 0;          ///< The same; of the current take.
  std::uint64_t lost_events_ = 0;         ///< The same.
  core::Gap lost_gap_;                    ///< The same; stood before frames that found no room.
};

}  // namespace dts::session
