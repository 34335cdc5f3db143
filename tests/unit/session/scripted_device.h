// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>

#include "device/device.h"

namespace dts::session {

/// A device that answers `read` with what the test wrote down; at the end of the script it runs `on_end`.
class ScriptedDevice final : public device::Device {
 public:
  struct Step {
    device::ReadOutcome outcome = device::ReadOutcome::Scans;
    std::size_t scans = 1;
    core::Gap gap{};
    std::uint64_t skip_index = 0;  ///< The device's counter jumps by this before the scans.
    std::int64_t pause_ns = 0;     ///< Host time that passes before the step.
  };

  explicit ScriptedDevice(std::deque<Step> script) : script_(std::move(script)) { description_.channels.resize(1); }

  std::function<void()> on_end;
  std::function<bool()> on_arrival_question = [] { return false; };
  double starts_at_rate_factor = 1.0;
  int starts = 0;
  int failing_opens = 0;
  int opens = 0;

  const device::DeviceDescription& describe() const noexcept override { return description_; }
  device::DeviceState state() const noexcept override { return state_; }
  core::Result<core::Rate> exact_rate(core::Rate wanted) const override { return wanted; }
  device::DeviceReport report() const override { return {}; }
  bool has_arrived() noexcept override { return on_arrival_question(); }
  core::Status set_sync_output(bool) override { return {}; }
  core::Status open() override {
    ++opens;
    if (failing_opens > 0) {
      --failing_opens;
      return core::fail(core::ErrorCode::NotFound, "not plugged in");
    }
    state_ = device::DeviceState::Open;
    return {};
  }
  core::Result<core::Rate> start(const device::StartOptions& options) override {
    ++starts;
    state_ = device::DeviceState::Streaming;
    index_ = 0;
    return core::Rate::from_hz(options.rate.hz() * starts_at_rate_factor);
  }
  device::ReadResult read(core::Block& block, std::int64_t) noexcept override {
    if (script_.empty()) {
      on_end();
      return {.outcome = device::ReadOutcome::Timeout, .gap = {}};
    }
    const Step step = script_.front();
    script_.pop_front();
    now_ns_ += step.pause_ns;
    if (step.outcome == device::ReadOutcome::Gone) state_ = device::DeviceState::Gone;
    if (step.outcome == device::ReadOutcome::Gap) index_ = 0;
    if (step.outcome != device::ReadOutcome::Scans) return {.outcome = step.outcome, .gap = step.gap};
    index_ += step.skip_index;
    block.set_count(step.scans);
    block.first_scan = {index_};
    block.host_time_ns = now_ns_;
    for (double& value : block.column(0)) value = static_cast<double>(index_++);
    now_ns_ += static_cast<std::int64_t>(step.scans) * kPeriodNs;
    return {.outcome = step.outcome, .gap = {}};
  }
  void interrupt() noexcept override {}
  core::Status stop() override {
    state_ = device::DeviceState::Open;
    return {};
  }
  core::Status close() override {
    state_ = device::DeviceState::Closed;
    return {};
  }

  void extend(const std::deque<Step>& steps) { script_.insert(script_.end(), steps.begin(), steps.end()); }

  static constexpr std::int64_t kPeriodNs = 10'000'000;  // 100 Hz

 private:
  device::DeviceDescription description_;
  std::deque<Step> script_;
  device::DeviceState state_ = device::DeviceState::Closed;
  std::uint64_t index_ = 0;
  std::int64_t now_ns_ = 1'000'000'000;
};

}  // namespace dts::session
