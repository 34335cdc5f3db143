// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/clock.h"
#include "device/device.h"
#include "device/device_entry.h"
#include "device/replay/play_queue.h"
#include "device/replay/recorded_device.h"

namespace dts::device::replay {

/// Speed and repetition of a replay.
struct PlayOptions {
  std::optional<double> speed = 1.0;  ///< No value: as fast as the reader.
  bool loops = false;
};

/// Creates "replay:FILE?speed=1|0.1..100|max&loop=0|1", which plays a recording. See README.md.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_replay(const DeviceUri& uri, const DeviceContext& context);

/// A recording as a device: the recorded scans, quality bits and gaps, at the recorded rate.
///
/// Host times are those of a device that runs now: start + (scans + missing scans) / rate. They do not depend on the speed, so all later
/// stages see the recorded time axis. The speed only determines when a scan is delivered.
class ReplayDevice final : public Device {
 public:
  ReplayDevice(RecordedDevice recorded, std::unique_ptr<record::Recording> recording, PlayOptions options, core::Clock& clock);
  ~ReplayDevice() override;
  ReplayDevice(const ReplayDevice&) = delete;
  ReplayDevice& operator=(const ReplayDevice&) = delete;

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return recorded_.description; }
  [[nodiscard]] DeviceState state() const noexcept override { return state_.load(std::memory_order_acquire); }  // pairs with move_to
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] DeviceReport report() const override;
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const StartOptions& options) override;
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  void interrupt() noexcept override { is_interrupted_.store(true, std::memory_order_release); }  // pairs with wait_until_due
  [[nodiscard]] core::Status set_sync_output(bool is_high) override;
  core::Status stop() override;
  core::Status close() override;

 private:
  void move_to(DeviceState state) noexcept { state_.store(state, std::memory_order_release); }  // pairs with state()
  [[nodiscard]] PlayedItem* wait_for_item(std::int64_t deadline_ns) noexcept;
  [[nodiscard]] std::uint64_t wait_until_due(std::uint64_t scans, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] std::int64_t instant_ns(std::uint64_t position) const noexcept;
  [[nodiscard]] std::int64_t due_ns(std::uint64_t position) const noexcept;
  [[nodiscard]] bool is_given_up(std::int64_t deadline_ns) noexcept;
  [[nodiscard]] ReadResult read_scans(core::Block& block, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] ReadResult read_gap(const core::Gap& gap, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] ReadResult reach_end(const PlayedItem& item) noexcept;
  void copy(const core::Block& from, core::Block& to, std::size_t at, std::size_t scans) noexcept;

  RecordedDevice recorded_;
  std::unique_ptr<record::Recording> recording_;
  PlayOptions options_;
  core::Clock& clock_;
  PlayQueue queue_;
  std::atomic<DeviceState> state_{DeviceState::Closed};
  std::atomic<bool> is_interrupted_{false};
  std::atomic<bool> has_ended_{false};
  std::array<char, 512> fault_{};  ///< Why playback ended early.

  std::size_t max_block_scans_ = 0;
  std::int64_t start_ns_ = 0;
  std::uint64_t position_ = 0;   ///< Played and missing scans since start.
  std::uint64_t paced_ = 0;      ///< Like `position_`, but a long gap counts only up to the longest wait.
  std::uint64_t next_scan_ = 0;  ///< Index of the next scan since the last gap.
  std::size_t taken_ = 0;        ///< Number of delivered scans of the queue's front block.
};

}  // namespace dts::device::replay
