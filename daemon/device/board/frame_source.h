// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>

#include "core/clock.h"
#include "core/latest_value.h"
#include "device/board/board_facts.h"
#include "device/board/frame_decoder.h"
#include "device/board/frames.h"
#include "device/board/link_input.h"
#include "device/board/scan_source.h"

namespace dts::device::board {

using FrameInput = LinkInput<FrameDecoder>;

/// How the scan of a board was started.
struct RunStart {
  bool is_commanded = false;  ///< The board has confirmed a STOP and then our START: it counts from 0 in a new run.
  WireRate wanted{};          ///< For a START after a reset.
  WireRate confirmed{};       ///< Rate in the DESCRIPTOR that confirmed the start.
};

/// Scans of a board that speaks frames.
///
/// - Same run: the counter shows the exact loss, also before the first scan of a run that we started. A counter that runs backwards breaks
///   the scan.
/// - New run: the board was reset; the loss is estimated from time.
/// - Not streaming any more, though we did not stop it: the board was reset and waits; it is started again.
/// - A description that differs or is rejected, or the test pattern: the scan is broken, and the next start asks for the description again.
class FrameSource final : public ScanSource {
 public:
  /// The facts must be agreed; they change if the board describes itself differently. All references must outlive the source.
  FrameSource(bytes::ByteLink& link, FrameInput& input, BoardFacts& facts, Timeline& timeline, core::Clock& clock, const RunStart& start,
              std::size_t max_block_scans);

  [[nodiscard]] bytes::ReadEnd pull(std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] bool ask() noexcept override;
  [[nodiscard]] bool start_again() noexcept override;
  /// 3 s if the board does not know its rate.
  [[nodiscard]] std::int64_t silence_ns() const noexcept override;

  /// Returns how many scans the board has made in this run that are not in the queue, if the board stopped with `counter` as its next scan;
  /// nothing if the run is not known.
  [[nodiscard]] std::optional<std::uint32_t> scans_until(std::uint8_t run, std::uint32_t counter) const noexcept;
  /// The newest text that the board has logged. Thread: any one.
  [[nodiscard]] ShortText<120> last_log() noexcept { return last_log_.load(); }
  [[nodiscard]] InputCounts counts() const noexcept override;

 private:
  void handle(std::span<const std::uint8_t> payload, std::int64_t raw_ns) noexcept;
  void handle_descriptor(std::span<const std::uint8_t> payload) noexcept;
  void handle_channel(std::span<const std::uint8_t> payload) noexcept;
  void handle_lost(std::span<const std::uint8_t> payload) noexcept;
  void handle_scans(std::span<const std::uint8_t> payload, std::int64_t raw_ns) noexcept;
  [[nodiscard]] bool follows(const Scans& scans, std::int64_t raw_ns) noexcept;
  void add_scans(const Scans& scans, std::int64_t raw_ns) noexcept;
  void refuse() noexcept { ++rejected_; }
  void refuse_description(const Refusal& refusal) noexcept;
  [[nodiscard]] core::GapReason reason_of_gap(std::uint32_t lost) const noexcept;

  bytes::ByteLink& link_;
  FrameInput& input_;
  BoardFacts& facts_;
  core::Clock& clock_;
  RunStart start_;
  std::optional<std::uint8_t> run_;
  std::uint32_t next_counter_ = 0;         ///< Of the next scan in `run_`.
  std::uint64_t number_ = 0;               ///< Of the next scan for the timeline.
  std::uint64_t counted_missing_ = 0;      ///< Reported as lost since the newest scan.
  std::optional<Lost> lost_;               ///< The newest LOST about scans that have not come yet.
  std::int64_t started_again_ns_;          ///< When the board was started the last time.
  std::span<const std::uint8_t> pending_;  ///< A SCANS frame behind a gap.
  std::int64_t pending_raw_ns_ = 0;
  core::LatestValue<ShortText<120>> last_log_;
  std::uint64_t rejected_ = 0;  ///< Frames with a rejected field.
};

}  // namespace dts::device::board
