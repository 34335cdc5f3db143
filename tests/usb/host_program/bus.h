// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// What the program needs of a host: umockdev or vhci.
class Bus {
 public:
  virtual ~Bus() = default;
  [[nodiscard]] virtual core::Status plug(EmulatedDevice& device) = 0;
  virtual void unplug(EmulatedDevice& device) = 0;
  virtual void locked(EmulatedDevice& device, const std::function<void()>& action) = 0;
  /// What a child needs in its environment to see the bus.
  [[nodiscard]] virtual std::vector<std::string> environment() const { return {}; }
};

/// "umockdev", where this program was built with it, or "vhci". InvalidArgument, or why it cannot be used here.
[[nodiscard]] core::Result<std::unique_ptr<Bus>> create_bus(std::string_view kind);

}  // namespace dts::emulator
