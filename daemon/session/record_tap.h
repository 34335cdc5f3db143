// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

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
/// that finds the ring full is dropped and counted: the recorder sees it by the scan indices, and the recording is incomplete.
class RecordTap {
 public:
  struct Slot {
    core::Frame frame;
    std::uint64_t take = 0;
    bool is_end = false;  ///< No frame: the take is over.
  };

  RecordTap(std::size_t slots, const pipeline::Pipeline& pipeline);

  /// Number of the take that `open` will begin. Thread: control.
  [[nodiscard]] std::uint64_t next_take() const noexcept { return takes_ + 1; }
  /// Begins a take. The one before must have been closed and read to its end. Thread: control.
  void open() noexcept { wanted_.store(++takes_, std::memory_order_release); }  // pairs with follow()
  /// Ends it: an end mark follows its last frame. Thread: control.
  void close() noexcept { wanted_.store(0, std::memory_order_release); }  // pairs with follow()

  /// Does what `open` and `close` asked for. Call it before every frame, and now and then while there is none.
  /// Thread: pipeline. Realtime-safe: yes.
  void follow() noexcept;
  /// A take is under way and there is no room for a frame. Thread: pipeline. Realtime-safe: yes.
  [[nodiscard]] bool is_blocked() noexcept { return current_ != 0 && ring_.claim() == nullptr; }
  /// Copies a frame for the recorder if a take is under way. Thread: pipeline. Realtime-safe: yes.
  void offer(const core::Frame& frame) noexcept;

  /// The oldest slot, or nullptr; give it back with `release`. Thread: record.
  [[nodiscard]] const Slot* front() noexcept { return ring_.front(); }
  void release() noexcept { ring_.release(); }
  /// State of the stages before the first frame of the take. Thread: record, once that frame was seen.
  [[nodiscard]] std::span<const double> state() const noexcept { return state_; }
  /// Frames that found no room, ever. Thread: any.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return ring_.dropped(); }

 private:
  const pipeline::Pipeline& pipeline_;
  core::SpscRing<Slot> ring_;
  std::vector<double> state_;  ///< Written by the pipeline thread before the take's first commit, which the record thread sees first.
  std::atomic<std::uint64_t> wanted_{0};
  std::uint64_t takes_ = 0;    ///< Control's.
  std::uint64_t current_ = 0;  ///< The pipeline thread's.
};

}  // namespace dts::session
