// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "bench/peer_protocol.h"
#include "core/clock.h"
#include "device/device.h"

namespace dts::bench {

/// A device that delivers one full block per message of a plan, on an absolute schedule, and stamps the newest scan with the
/// moment of handing it over: what the other peers' producers do just before their push call.
///
/// It waits silently until `begin`, and again after the last message. Block capacity and chunk must be equal.
class ScheduledDevice final : public device::Device {
 public:
  /// `tick_ns`: all messages due within a tick go out in one go; 0: each on its own. `clock` outlives the device.
  ScheduledDevice(const Plan& plan, std::size_t channels, core::Rate rate, std::int64_t tick_ns, core::Clock& clock);

  /// The first message is due at `at_ns`. Thread: any.
  void begin(std::int64_t at_ns) noexcept { begin_ns_.store(at_ns, std::memory_order_release); }    // pairs with read()
  [[nodiscard]] bool is_done() const noexcept { return is_done_.load(std::memory_order_acquire); }  // pairs with note_progress()

  /// Once done: what the process used from the first measured message to the last, and how late messages were at most.
  [[nodiscard]] const ProcessUse& use_at_begin() const noexcept { return use_at_begin_; }
  [[nodiscard]] const ProcessUse& use_at_end() const noexcept { return use_at_end_; }
  [[nodiscard]] std::int64_t latest_ns() const noexcept { return latest_ns_; }
  /// The longest turn of the reading thread: from the end of one read to the begin of the next.
  [[nodiscard]] std::int64_t longest_turn_ns() const noexcept { return longest_turn_ns_; }

  [[nodiscard]] const device::DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] device::DeviceState state() const noexcept override { return state_; }
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override { return wanted; }
  [[nodiscard]] device::DeviceReport report() const override { return {}; }
  [[nodiscard]] core::Status set_sync_output(bool) override { return {}; }
  [[nodiscard]] core::Status open() override;
  [[nodiscard]] core::Result<core::Rate> start(const device::StartOptions& options) override;
  [[nodiscard]] device::ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] bool has_more() noexcept override;
  void interrupt() noexcept override { is_interrupted_.store(true, std::memory_order_release); }  // pairs with read()
  core::Status stop() override;
  core::Status close() override;

 private:
  [[nodiscard]] std::int64_t due_ns(std::int64_t begin_ns) noexcept;
  void note_progress() noexcept;
  void note_turn() noexcept;
  void fill(core::Block& block) noexcept;

  Plan plan_;
  core::Rate rate_;
  std::int64_t tick_ns_;
  core::Clock& clock_;
  device::DeviceDescription description_;
  device::DeviceState state_ = device::DeviceState::Closed;
  std::atomic<std::int64_t> begin_ns_{0};
  std::atomic<bool> is_done_{false};
  std::atomic<bool> is_interrupted_{false};
  std::uint64_t message_ = 0;
  std::int64_t next_tick_ns_ = 0;
  std::uint32_t random_ = 12345;
  std::int64_t latest_ns_ = 0;
  std::int64_t handed_over_ns_ = 0;
  std::int64_t longest_turn_ns_ = 0;
  ProcessUse use_at_begin_;
  ProcessUse use_at_end_;
};

}  // namespace dts::bench
