// SPDX-License-Identifier: Apache-2.0
#include "device/device_checks.h"

#include <string>

namespace dts::device {

using core::ErrorCode;

core::Result<core::Rate> check_rate(const DeviceDescription& description, core::Rate wanted) {
  // A limit of 500000/3 Hz must be reachable by a rate written in decimals (core::Rate::from_hz: 1e-6 Hz).
  constexpr double kRounding = 1e-8;
  constexpr double kRoundingHz = 1e-6;
  const double rate_hz = wanted.hz();
  const bool is_fast_enough = rate_hz >= description.minimum_rate_hz * (1.0 - kRounding) - kRoundingHz;
  if (is_fast_enough && rate_hz <= description.maximum_rate_hz * (1.0 + kRounding) + kRoundingHz) return wanted;
  return core::fail(ErrorCode::InvalidArgument, description.uri + " cannot run at " + std::to_string(rate_hz) + " Hz",
                    "choose " + std::to_string(description.minimum_rate_hz) + " to " + std::to_string(description.maximum_rate_hz) + " Hz");
}

core::Status check_start(const DeviceDescription& description, const StartOptions& options) {
  DTS_TRY(check_rate(description, options.rate));
  if (options.max_block_scans >= 1 && options.max_block_scans <= core::kMaxBlockScans) return {};
  return core::fail(ErrorCode::InvalidArgument,
                    "cannot start " + description.uri + ": blocks of " + std::to_string(options.max_block_scans) + " scans",
                    "choose 1 to " + std::to_string(core::kMaxBlockScans));
}

core::Status refuse_sync_output(const DeviceDescription& description, DeviceState state) {
  if (state == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, description.uri + " is gone");
  if (state == DeviceState::Closed) return core::fail(ErrorCode::WrongState, description.uri + " is not open");
  return core::fail(ErrorCode::Unsupported, description.uri + " has no digital output for a sync pulse");
}

}  // namespace dts::device
