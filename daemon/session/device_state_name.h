// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "device/device.h"

namespace dts::session {

/// Returns one word for logs and recordings: "streaming".
[[nodiscard]] constexpr std::string_view name(device::DeviceState state) noexcept {
  switch (state) {
    case device::DeviceState::Closed: return "closed";
    case device::DeviceState::Open: return "open";
    case device::DeviceState::Streaming: return "streaming";
    case device::DeviceState::Gone: return "gone";
  }
  return "unknown";
}

}  // namespace dts::session
