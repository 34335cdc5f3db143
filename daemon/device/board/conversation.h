// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/clock.h"
#include "device/board/board_options.h"
#include "device/board/frame_source.h"

namespace dts::device::board {

/// The commands to a board that speaks frames, and its answers. Thread: the owner of the device; never while scans are read.
class Conversation {
 public:
  Conversation(bytes::ByteLink& link, const BoardOptions& options, core::Clock& clock);

  /// Asks an opened link's board for its description, for at most 6 s, compares it with the address, and stops a scan or a pattern that
  /// runs. Measures the rate of a board that does not know it. Fails with Timeout, DeviceGone, DataDamaged, InvalidArgument, Failed.
  [[nodiscard]] core::Status meet();
  /// Starts the scan; the answer says how. Does `meet` first if the board's description is not agreed. Fails with InvalidArgument if the
  /// board cannot run at `rate`, and like `meet`.
  [[nodiscard]] core::Result<RunStart> start(core::Rate rate);
  /// Stops the scan within 200 ms and returns the number of scans that `source` did not put into its queue: nothing if the board did not
  /// say it. Fails with Timeout if the board does not answer, with DeviceGone if the link is lost.
  [[nodiscard]] core::Result<std::optional<std::uint32_t>> stop(const FrameSource& source);

  [[nodiscard]] BoardFacts& facts() noexcept { return facts_; }
  [[nodiscard]] FrameInput& input() noexcept { return input_; }
  /// The measured rate of a board that does not know it, Hz; 0: not measured.
  [[nodiscard]] double measured_hz() const noexcept { return measured_hz_; }

 private:
  using Condition = std::function<bool(const Descriptor&)>;
  /// Handles the next frame. Fails with DeviceGone if the link is lost; false: none came in time.
  [[nodiscard]] core::Result<bool> listen(std::int64_t deadline_ns);
  void handle(std::span<const std::uint8_t> payload, std::int64_t raw_ns);
  void refuse(const Refusal& refusal);
  void note_scans(std::span<const std::uint8_t> payload, std::int64_t raw_ns);
  [[nodiscard]] core::Status learn();
  [[nodiscard]] core::Status command(const EncodedFrame& frame, const char* name, const Condition& is_answer);
  [[nodiscard]] core::Status send(const EncodedFrame& frame);
  [[nodiscard]] core::Status halt();
  [[nodiscard]] core::Status catch_up();
  [[nodiscard]] core::Result<RunStart> begin_run(core::Rate rate);
  [[nodiscard]] core::Status check_serial() const;
  [[nodiscard]] core::Status measure_rate();
  [[nodiscard]] core::Status check_rate(core::Rate wanted, const std::string& what);
  [[nodiscard]] core::Error unanswered(const std::string& what) const;

  /// A SCANS frame of the rate measurement.
  struct Arrived {
    std::uint8_t run = 0;
    std::uint32_t counter = 0;  ///< Of the first scan.
    std::uint32_t ticks = 0;
    std::uint32_t last = 0;  ///< Counter of the last scan.
    std::int64_t raw_ns = 0;
  };
  /// The first and the newest one.
  struct Span {
    Arrived first;
    Arrived newest;
  };

  bytes::ByteLink& link_;
  const BoardOptions& options_;
  core::Clock& clock_;
  FrameInput input_;
  BoardFacts facts_;
  std::uint64_t descriptors_ = 0;    ///< Number of DESCRIPTORs that have arrived.
  std::int64_t newest_fact_ns_ = 0;  ///< When the newest DESCRIPTOR or CHANNEL arrived.
  std::optional<Refusal> refusal_;   ///< The newest rejected DESCRIPTOR or CHANNEL.
  std::optional<Lost> stopped_;      ///< The newest LOST with reason 4.
  std::optional<Span> span_;         ///< Scans since it was reset.
  double measured_hz_ = 0.0;
};

}  // namespace dts::device::board
