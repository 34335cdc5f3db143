// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "support/test_device.h"

namespace dts::session {

/// Time passes only when the test advances it. Sleepers return early, after a millisecond of the machine's time: the threads go on looking.
class HandClock final : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
  void sleep_until_ns(std::int64_t) noexcept override { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }
  [[nodiscard]] std::int64_t utc_minus_monotonic_ns() const noexcept override { return utc_minus_now_ns_ + set_by_ns; }
  void advance_s(double s) { now_ns_ += static_cast<std::int64_t>(s * 1e9); }

  std::atomic<std::int64_t> set_by_ns{0};  ///< The wall clock can be set.

 private:
  static constexpr std::int64_t kBootNs = 5'000'000'000'000;
  std::atomic<std::int64_t> now_ns_{kBootNs};
  std::int64_t utc_minus_now_ns_ = core::SystemClock().now_ns() + core::SystemClock().utc_minus_monotonic_ns() - kBootNs;
};

/// A device that delivers what the test gives it.
class HandFedDevice final : public device::TestDevice {
 public:
  struct Given {
    device::ReadOutcome outcome = device::ReadOutcome::Scans;
    std::size_t scans = 0;
    std::int64_t host_ns = 0;
    core::Gap gap{};
  };

  explicit HandFedDevice(std::size_t channels) {
    description_.uri = "hand:fed";
    description_.model = "Hand-fed device";
    description_.serial = "H7";
    description_.has_sync_output = true;
    for (std::size_t i = 0; i < channels; ++i) {
      description_.channels.push_back({.name = "ch" + std::to_string(i), .unit = "V", .minimum = -10.0, .maximum = 10.0});
    }
  }

  void give(const Given& given) {
    const std::lock_guard lock(mutex_);
    given_.push_back(given);
    is_given_.notify_one();
  }

  // Of the test's thread, before the device starts or between two ticks:
  std::atomic<bool> is_absent = false;
  device::DeviceReport found{.serial = "", .nodes = {}, .firmware = "1.2", .checks = {}};
  std::atomic<std::size_t> stuck_channel = 99;
  std::atomic<bool> is_empty = false;  ///< Nobody is on the plate.
  core::Status sync_answer{};
  std::vector<bool> sync_outputs{};
  std::vector<device::Cue> cues{};

  device::DeviceReport report() const override { return found; }
  core::Status open() override {
    if (is_absent) return core::fail(core::ErrorCode::NotFound, "not plugged in");
    return TestDevice::open();
  }
  device::ReadResult read(core::Block& block, std::int64_t) noexcept override {
    std::unique_lock lock(mutex_);
    if (!is_given_.wait_for(lock, std::chrono::milliseconds(1), [this] { return !given_.empty(); })) {
      return {.outcome = device::ReadOutcome::Timeout, .gap = {}};
    }
    const Given given = given_.front();
    given_.pop_front();
    if (given.outcome != device::ReadOutcome::Scans) return without_scans(given.outcome, given.gap);
    block.set_count(given.scans);
    block.first_scan = {index_};
    block.host_time_ns = given.host_ns;
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      for (std::size_t i = 0; i < given.scans; ++i) {
        block.column(channel)[i] = is_empty ? empty_volts(index_ + i) : volts(channel, channel == stuck_channel ? 0 : index_ + i);
      }
    }
    index_ += given.scans;
    return {.outcome = given.outcome, .gap = {}};
  }
  void hear(const device::Cue& cue) noexcept override { cues.push_back(cue); }
  core::Status set_sync_output(bool is_high) override {
    sync_outputs.push_back(is_high);
    return sync_answer;
  }
  /// The unloaded gap of 12 mm, with noise: a sensor that shows always the same counts as stuck.
  static double empty_volts(std::uint64_t scan) { return 0.9 + 0.001 * static_cast<double>(scan % 7); }
  /// Somebody sways: no two sensors show the same, and none is still.
  static double volts(std::size_t channel, std::uint64_t scan) {
    const double phase = static_cast<double>(scan % 1000) / 1000.0 + 0.2 * static_cast<double>(channel);
    return 2.0 + 0.1 * static_cast<double>(channel) + 0.05 * (phase - static_cast<double>(static_cast<std::int64_t>(phase)));
  }

 private:
  std::mutex mutex_;
  std::condition_variable is_given_;
  std::deque<Given> given_;
};

}  // namespace dts::session
