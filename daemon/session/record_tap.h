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

/// Branches a rig's frames off to the recorder: a ring of several seconds between the pipeline thread and the record thread.
///
///     control:   open() -> take 3                        close()
///     pipeline:            [save state] frame frame frame ...  frame  end
///     record:                           take 3: state, then frames, until the end mark
///
/// A take is one recording. The state of the stages is saved just before its first frame, so that a replay can start from there. If the
/// ring is full, the frame is dropped; every later slot of the take, the end mark too, carries the number of scans lost so far. So even a
/// loss that no scan index shows (at the end, or before a new segment) makes the recording incomplete.
class RecordTap {
 public:
  struct Slot {
    core::Frame frame;
    std::uint64_t take = 0;
    bool is_end = false;            ///< No frame: this slot ends the take.
    std::uint64_t lost_scans = 0;   ///< Scans of this take that were dropped before this slot.
    std::uint64_t lost_events = 0;  ///< Events dropped from frames that were themselves kept.
  };

  RecordTap(std::size_t slots, const pipeline::Pipeline& pipeline);

  /// Returns the number of the take that `open` will begin. Thread: control.
  [[nodiscard]] std::uint64_t next_take() const noexcept { return takes_ + 1; }
  /// Begins a take. The previous take must be closed and read to its end. Thread: control.
  void open() noexcept { opened_.store(++takes_, std::memory_order_release); }  // pairs with follow()
  /// Ends the take: an end mark follows its last frame, even if the pipeline thread has not yet seen the take begin. Thread: control.
  void close() noexcept { closed_.store(takes_, std::memory_order_release); }  // pairs with follow()

  /// Executes the requests of `open` and `close`. Call it before every frame, and regularly while there are no frames.
  /// Thread: pipeline. Realtime-safe: yes.
  void follow() noexcept;
  /// Returns whether a take is open and the ring is full. Thread: pipeline. Realtime-safe: yes.
  [[nodiscard]] bool is_blocked() noexcept { return current_ != 0 && ring_.claim() == nullptr; }
  /// Copies a frame and its events to the recorder if a take is open. If the frame is dropped, its events are dropped too: a replay could
  /// not reproduce them. Thread: pipeline. Realtime-safe: yes.
  void offer(const core::Frame& frame, const core::FrameEvents& events = {}) noexcept;

  /// Returns the events of the slots (`Frame::event_count`). Thread: record.
  [[nodiscard]] core::EventLane& events() noexcept { return events_; }
  /// Returns the oldest slot, or nullptr; free it with `release`. Thread: record.
  [[nodiscard]] const Slot* front() noexcept { return ring_.front(); }
  void release() noexcept { ring_.release(); }
  /// Returns the state of the stages before the first frame of the take. Thread: record, once that frame was seen.
  [[nodiscard]] std::span<const double> state() const noexcept { return state_; }
  /// Returns the number of frames dropped since the start. Thread: any.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return ring_.dropped(); }
  /// Returns the number of slots that wait for the recorder. Thread: any.
  [[nodiscard]] std::size_t waiting() const noexcept { return ring_.waiting(); }
  /// Returns the total number of slots. Thread: any.
  [[nodiscard]] std::size_t capacity() const noexcept { return ring_.capacity(); }

 private:
  [[nodiscard]] bool end_closed() noexcept;

  const pipeline::Pipeline& pipeline_;
  core::SpscRing<Slot> ring_;
  core::EventLane events_;
  std::vector<double> state_;  ///< Written by the pipeline thread before the take's first commit; the record thread reads it after that.
  std::atomic<std::uint64_t> opened_{0};  ///< Newest take that was opened.
  std::atomic<std::uint64_t> closed_{0};  ///< Newest take that was closed.
  std::uint64_t takes_ = 0;               ///< Control thread only.
  std::uint64_t current_ = 0;             ///< Pipeline thread only, like all below. 0: no take is open.
  std::uint64_t begun_ = 0;               ///< Newest take that was current.
  std::uint64_t lost_scans_ = 0;          ///< In the current take.
  std::uint64_t lost_events_ = 0;         ///< In the current take.
  core::Gap lost_gap_;                    ///< Gap before dropped frames; goes with the next frame that is kept.
};

}  // namespace dts::session
