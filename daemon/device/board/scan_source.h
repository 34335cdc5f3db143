// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include "device/board/frame_decoder.h"
#include "device/board/scan_queue.h"
#include "device/board/timeline.h"
#include "device/bytes/byte_link.h"
#include "device/device.h"

namespace dts::device::board {

/// Numbers of scans that a source has found missing since the start. Thread: written by the reader, read by any.
struct LossCounts {
  std::atomic<std::uint64_t> counted{0};
  std::atomic<std::uint64_t> estimated{0};
};

/// What frames and lines have in common: turns the pieces of a link into scans, and finds every loss. A loss stops the intake until the
/// scans before it are delivered and the loss is reported; the piece behind it is kept. Thread: the reader. Realtime-safe: yes.
class ScanSource {
 public:
  /// `timeline` must outlive the source.
  ScanSource(Timeline& timeline, std::size_t channels, std::size_t capacity) : queue_(channels, capacity), timeline_(timeline) {}
  virtual ~ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;

  /// Handles the next piece, and waits for it until `deadline_ns`. Returns Bytes if a piece was handled. Needs: no trouble, and room for
  /// one frame of scans in the queue.
  [[nodiscard]] virtual bytes::ReadEnd pull(std::int64_t deadline_ns) noexcept = 0;
  /// Asks a silent board whether it is there. Waits up to 100 ms, and a failed write allocates. Returns false if the link is lost.
  [[nodiscard]] virtual bool ask() noexcept = 0;
  /// Starts a silent board again; its next scans are a new segment. Waits and allocates as `ask`. Returns false if the link is lost.
  [[nodiscard]] virtual bool start_again() noexcept = 0;

  /// Returns how long no scans may arrive until the board counts as silent: 1 s and 2 periods.
  [[nodiscard]] virtual std::int64_t silence_ns() const noexcept { return core::kNanosecondsPerSecond + 2 * timeline_.period_ns(); }
  /// Numbers of good and bad pieces since the link was opened.
  [[nodiscard]] virtual InputCounts counts() const noexcept = 0;

  [[nodiscard]] ScanQueue& queue() noexcept { return queue_; }
  [[nodiscard]] Timeline& timeline() noexcept { return timeline_; }
  [[nodiscard]] const LossCounts& losses() const noexcept { return losses_; }
  /// Time of the newest scans, by `now_ns`; the start counts as one.
  [[nodiscard]] std::int64_t newest_ns() const noexcept { return newest_ns_; }

  [[nodiscard]] bool has_trouble() const noexcept { return trouble_.outcome != ReadOutcome::Scans; }
  void set_trouble(ReadOutcome outcome, core::GapReason reason) noexcept { trouble_ = {outcome, {reason, 0, false}}; }
  /// `why`: what is wrong and what to do, for the report; a literal.
  void break_off(const char* why) noexcept {
    set_trouble(ReadOutcome::Broken, core::GapReason::Integrity);
    why_broken_.store(why, std::memory_order_relaxed);  // only for the report
  }
  /// Returns why the scan broke off; null: it did not. Thread: any.
  [[nodiscard]] const char* why_broken() const noexcept { return why_broken_.load(std::memory_order_relaxed); }
  [[nodiscard]] const ReadResult& trouble() const noexcept { return trouble_; }
  /// Returns the trouble; a Gap is over then, Broken and Gone stay.
  [[nodiscard]] ReadResult take_trouble() noexcept {
    return trouble_.outcome == ReadOutcome::Gap ? std::exchange(trouble_, {ReadOutcome::Scans, {}}) : trouble_;
  }

 protected:
  void report_loss(core::GapReason reason, std::uint64_t scans, bool is_exact) noexcept {
    trouble_ = {ReadOutcome::Gap, {reason, scans, is_exact}};
    (is_exact ? losses_.counted : losses_.estimated).fetch_add(scans, std::memory_order_relaxed);  // only for the report
  }
  void note_scans(std::int64_t now_ns) noexcept { newest_ns_ = now_ns; }

 private:
  ScanQueue queue_;
  Timeline& timeline_;
  LossCounts losses_;
  ReadResult trouble_{ReadOutcome::Scans, {}};
  std::atomic<const char*> why_broken_{nullptr};
  std::int64_t newest_ns_ = 0;
};

}  // namespace dts::device::board
