// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/frame_ring.h"
#include "core/latest_value.h"
#include "pipeline/pipeline.h"
#include "session/recent_peak.h"

namespace dts::session {

/// What the recorder reads of a rig's ring: the frames of one take, which is one recording, and the state of the stages before it.
///
///     control:   open() -> take 3                        close(end of the newest frame)
///     rig:                 [save state] frame frame frame frame frame ...
///     record:                  take 3: state, then the frames up to that place, then the end
///
/// The state of the stages is saved just before the first frame, so that a replay can start from there. A recorder that is later than the
/// ring is long loses frames; from then on every item of the take, the end too, has the number of scans lost so far. So even a loss that
/// no scan index shows (at the end, or before a new segment) makes the recording incomplete.
class RecordTap {
 public:
  struct Item {
    const core::Frame* frame = nullptr;     ///< nullptr: the end of the take.
    std::span<const core::Event> events{};  ///< Of the frame.
    std::uint64_t take = 0;
    std::uint64_t lost_scans = 0;   ///< Scans of this take that are missing before this item.
    std::uint64_t lost_events = 0;  ///< Events of this take that are missing before this item.
  };

  /// Both must outlive this object.
  RecordTap(const core::FrameRing& frames, const pipeline::Pipeline& pipeline);

  /// Returns the number of the take that `open` will begin. Thread: control.
  [[nodiscard]] std::uint64_t next_take() const noexcept { return takes_ + 1; }
  /// Returns true if the newest take is closed and read to its end, or there was none. Thread: control.
  [[nodiscard]] bool is_done() const noexcept { return done_.load(std::memory_order_acquire) == takes_; }  // pairs with release()
  /// Begins a take with the next frame. Only if `is_done`. Thread: control.
  void open() noexcept { opened_.store(++takes_, std::memory_order_release); }  // pairs with begin_take()
  /// Ends the take at `end`. Thread: control.
  void close(const core::FramePosition& end) noexcept;

  /// Begins the take that was opened. Call it before the stages process a block. Thread: rig. Realtime-safe: yes.
  void begin_take() noexcept;
  /// Returns true if the next frame would overwrite one that the recorder has not read. Thread: rig. Realtime-safe: yes.
  [[nodiscard]] bool is_full() const noexcept { return waiting() >= frames_.capacity(); }

  /// Returns the next item of the take, valid until `release`, or nothing. Thread: record.
  [[nodiscard]] std::optional<Item> front() noexcept;
  /// Continues after the item that `front` returned. Thread: record.
  void release() noexcept;
  /// Returns the state of the stages before the first frame of the take. Thread: record, once that frame was seen.
  [[nodiscard]] std::span<const double> state() const noexcept { return state_; }
  /// Returns the number of frames that the ring holds. Thread: any.
  [[nodiscard]] std::size_t capacity() const noexcept { return frames_.capacity(); }
  /// Returns how many frames of the take wait for the recorder. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::size_t waiting() const noexcept;
  /// Returns how many frames waited for the recorder recently. Thread: control.
  [[nodiscard]] std::size_t recently_waiting(std::int64_t now_ns) noexcept { return waiting_.load().at(now_ns); }
  /// Notes how many frames wait. Thread: record.
  void note_waiting(std::int64_t now_ns) noexcept;

 private:
  [[nodiscard]] bool start_reading() noexcept;
  [[nodiscard]] Item end(std::uint64_t lost_scans, std::uint64_t lost_events) noexcept;

  const core::FrameRing& frames_;
  const pipeline::Pipeline& pipeline_;

  std::uint64_t takes_ = 0;               ///< Control thread only.
  core::FramePosition end_;               ///< Written before `closed_`.
  std::atomic<std::uint64_t> opened_{0};  ///< Newest take that was opened.
  std::atomic<std::uint64_t> closed_{0};  ///< Newest take that was closed.

  std::vector<double> state_;  ///< Written before `begun_`, like the next one; the record thread reads them after that.
  core::FramePosition begin_;
  std::atomic<std::uint64_t> begun_{0};  ///< Newest take that the rig thread has begun.

  std::atomic<std::uint64_t> read_{0};  ///< Number of frames before which the recorder has read all of the take.
  std::atomic<std::uint64_t> done_{0};  ///< Newest take that was read to its end.
  core::FrameReader reader_;            ///< Record thread only, like all below.
  std::uint64_t take_ = 0;              ///< The take that is being read; 0: none.
  std::optional<Item> last_item_;       ///< `front` returned the end.
  RecentPeak peak_;
  core::LatestValue<RecentPeak> waiting_;
};

}  // namespace dts::session
