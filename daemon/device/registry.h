// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/clock.h"
#include "core/result.h"
#include "device/device.h"
#include "device/usb/usb_bus.h"

namespace dts::physics {
struct RigModel;
}

namespace dts::device {

/// "scheme:name?key=value&key=value": the one string that chooses a device.
struct DeviceUri {
  std::string scheme;                          ///< "sim"
  std::string name;                            ///< "floor"
  std::map<std::string, std::string> options;  ///< {"seed": "7"}
  std::string text;                            ///< As given.

  /// Fails with InvalidArgument, naming the part, when the text is not of that form or a key stands twice.
  [[nodiscard]] static core::Result<DeviceUri> parse(std::string_view text);
};

/// What a factory may use. All of it outlives the device.
struct DeviceContext {
  core::Clock& clock;
  const physics::RigModel& rig;  ///< The plate that a simulated device bends.
  usb::UsbBus* usb = nullptr;    ///< For devices on a cable; without it they cannot be created.
};

using DeviceFactory = std::function<core::Result<std::unique_ptr<Device>>(const DeviceUri&, const DeviceContext&)>;

struct RegistryEntry {
  std::string scheme_and_name;  ///< "sim:floor"
  std::string sentence;         ///< For `dtsctl device list` and error messages.
  DeviceFactory create;
  std::vector<usb::UsbModel> usb_models{};  ///< Products on USB that it drives; empty: it is not found by looking.
};

/// All device kinds built into this program. A new device is one folder and one entry in registry.cpp.
[[nodiscard]] const std::vector<RegistryEntry>& registry();

/// Both would open the same unit: the same kind of hardware, and the serial numbers are equal or one of them is not given.
[[nodiscard]] bool compete(std::string_view one_uri, std::string_view other_uri);

/// Parses `uri` and creates the device (Closed). Errors name the URI, the unknown kind or option, and what is known.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_device(std::string_view uri, const DeviceContext& context);

}  // namespace dts::device
