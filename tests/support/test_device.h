// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "device/device.h"

namespace dts::device {

/// What devices of tests have in common: each opens, starts, stops and closes without a fault, at the wanted rate. A test adds what it
/// reads.
class TestDevice : public Device {
 public:
  const DeviceDescription& describe() const noexcept override { return description_; }
  DeviceState state() const noexcept override { return state_; }
  core::Result<core::Rate> exact_rate(core::Rate wanted) const override { return wanted; }
  DeviceReport report() const override { return {}; }
  core::Status open() override {
    state_ = DeviceState::Open;
    return {};
  }
  core::Result<core::Rate> start(const StartOptions& options) override {
    state_ = DeviceState::Streaming;
    index_ = 0;
    return options.rate;
  }
  void interrupt() noexcept override {}
  core::Status set_sync_output(bool) override { return {}; }
  core::Status stop() override {
    state_ = DeviceState::Open;
    return {};
  }
  core::Status close() override {
    state_ = DeviceState::Closed;
    return {};
  }

 protected:
  /// What `read` answers if it gives no scans: a gap begins a new segment, and a lost device is gone.
  ReadResult without_scans(ReadOutcome outcome, const core::Gap& gap = {}) noexcept {
    if (outcome == ReadOutcome::Gone) state_ = DeviceState::Gone;
    if (outcome == ReadOutcome::Gap) index_ = 0;
    return {.outcome = outcome, .gap = gap};
  }

  DeviceDescription description_;
  std::uint64_t index_ = 0;  ///< Of the next scan.

 private:
  std::atomic<DeviceState> state_ = DeviceState::Closed;
};

}  // namespace dts::device
