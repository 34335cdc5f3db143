// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/result.h"
#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// Emulated devices on the real kernel of this machine, or of a guest: vhci_hcd, the virtual host controller of USB/IP, fed over
/// a socket pair. No network, no usbip program. Needs root.
///
///     kernel: vhci_hcd --USB/IP messages over a socket pair--> VhciDevice --> RunningDevice --> EmulatedDevice
///
/// Thread: one.
class VhciHost {
 public:
  /// NotFound: the module is not loaded, or this kernel has none. NotAllowed: not root.
  [[nodiscard]] static core::Result<std::unique_ptr<VhciHost>> create();
  ~VhciHost();
  VhciHost(const VhciHost&) = delete;
  VhciHost& operator=(const VhciHost&) = delete;

  /// The kernel enumerates it by itself. `device` outlives the host, or is unplugged before.
  [[nodiscard]] core::Status plug(EmulatedDevice& device);
  void unplug(EmulatedDevice& device);
  /// Runs `action` while the device stands still.
  void locked(EmulatedDevice& device, const std::function<void()>& action);

 private:
  class Connection;
  VhciHost() = default;

  std::map<EmulatedDevice*, int> ports_;  ///< A device keeps its port over unplugging.
  std::map<EmulatedDevice*, std::unique_ptr<Connection>> plugged_;
};

}  // namespace dts::emulator
