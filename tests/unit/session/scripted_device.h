// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>

#include "support/test_device.h"

namespace dts::session {

/// A device that answers `read` with what the test wrote down; at the end of the script it runs `on_end`.
class ScriptedDevice final : public device::TestDevice {
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
  std::string reason;  ///< Why it is gone.
  double starts_at_rate_factor = 1.0;
  int starts = 0;
  int failing_opens = 0;
  int opens = 0;

  bool has_arrived() noexcept override { return on_arrival_question(); }
  std::string why_gone() const override { return reason; }
  core::Status open() override {
    ++opens;
    if (failing_opens > 0) {
      --failing_opens;
      return core::fail(core::ErrorCode::NotFound, "not plugged in");
    }
    return TestDevice::open();
  }
  core::Result<core::Rate> start(const device::StartOptions& options) override {
    ++starts;
    static_cast<void>(TestDevice::start(options));
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
    if (step.outcome != device::ReadOutcome::Scans) return without_scans(step.outcome, step.gap);
    index_ += step.skip_index;
    block.set_count(step.scans);
    block.first_scan = {index_};
    block.host_time_ns = now_ns_;
    for (double& value : block.column(0)) value = static_cast<double>(index_++);
    now_ns_ += static_cast<std::int64_t>(step.scans) * kPeriodNs;
    return {.outcome = step.outcome, .gap = {}};
  }
  void extend(const std::deque<Step>& steps) { script_.insert(script_.end(), steps.begin(), steps.end()); }

  static constexpr std::int64_t kPeriodNs = 10'000'000;  // 100 Hz

 private:
  std::deque<Step> script_;
  std::int64_t now_ns_ = 1'000'000'000;
};

}  // namespace dts::session
