// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "device/board/board_options.h"
#include "device/board/conversation.h"
#include "device/board/scan_delivery.h"
#include "device/board/timeline.h"
#include "device/bytes/byte_link.h"
#include "device/device.h"

namespace dts::device::board {

/// A microcontroller or a program as a DAQ, over any byte link, with frames or lines.
class BoardDevice final : public Device {
 public:
  /// `clock` must outlive the device.
  BoardDevice(BoardOptions options, std::unique_ptr<bytes::ByteLink> link, core::Clock& clock);
  ~BoardDevice() override;
  BoardDevice(const BoardDevice&) = delete;
  BoardDevice& operator=(const BoardDevice&) = delete;

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return options_.description; }
  [[nodiscard]] DeviceState state() const noexcept override { return state_.load(std::memory_order_acquire); }  // pairs with move_to
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] DeviceReport report() const override;
  [[nodiscard]] bool has_arrived() noexcept override { return link_->has_arrived(); }
  [[nodiscard]] std::string why_gone() const override;
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const StartOptions& options) override;
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] bool has_more() noexcept override { return state() == DeviceState::Streaming && delivery_->has_more(); }
  void interrupt() noexcept override;
  [[nodiscard]] core::Status set_sync_output(bool is_high) override;
  core::Status stop() override;
  core::Status close() override;

 private:
  void move_to(DeviceState state) noexcept { state_.store(state, std::memory_order_release); }  // pairs with state()
  [[nodiscard]] core::Status meet();
  [[nodiscard]] core::Status meet_lines();
  void note_unit();
  [[nodiscard]] core::Status begin(const StartOptions& options);
  [[nodiscard]] core::Status end_scan();
  void add_log(std::vector<DeviceCheck>& checks) const;
  void keep_findings(std::optional<std::uint64_t> undelivered);
  [[nodiscard]] std::string what_came_instead() const;

  /// What has arrived on the link since it was opened.
  struct Heard {
    std::uint64_t bytes = 0;
    InputCounts pieces;
  };
  [[nodiscard]] Heard heard() const noexcept;

  BoardOptions options_;
  std::unique_ptr<bytes::ByteLink> link_;
  core::Clock& clock_;
  std::atomic<DeviceState> state_{DeviceState::Closed};
  std::atomic<bool> is_interrupted_{false};
  std::unique_ptr<Conversation> conversation_;  ///< For frames, while the link is open.
  std::unique_ptr<LineInput> lines_;            ///< For lines, while the link is open.
  Timeline timeline_;                           ///< Kept from scan to scan, because it knows the drift of the board's clock.
  std::string timed_serial_;                    ///< The unit whose clock that is.
  /// Protects everything that `report` reads; locked for short times only.
  mutable std::mutex report_mutex_;
  DeviceReport report_;                   ///< Filled by `open`.
  std::vector<DeviceCheck> scan_checks_;  ///< Of the last scan, after its end.
  std::unique_ptr<ScanSource> source_;
  FrameSource* frames_ = nullptr;  ///< `source_`, if the board speaks frames.
  std::string why_broken_before_;  ///< Why the last scan since `open` that broke off did so; empty: none.
  std::unique_ptr<ScanDelivery> delivery_;
  Heard heard_at_scan_;  ///< At the newest delivered scan. Thread: the reader; the owner after Gone.
};

}  // namespace dts::device::board
