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

/// "scheme:name?key=value&key=value": selects and configures a device.
struct DeviceUri {
  std::string scheme;                          ///< "sim"
  std::string name;                            ///< "floor"
  std::map<std::string, std::string> options;  ///< {"seed": "7"}
  std::string text;                            ///< As the user wrote it.

  /// Parses `text`. Fails with InvalidArgument, naming the wrong part, if the text is not of that form or a key occurs twice.
  [[nodiscard]] static core::Result<DeviceUri> parse(std::string_view text);
};

/// Objects that a factory may use. All of them must outlive the device.
struct DeviceContext {
  core::Clock& clock;
  const physics::RigModel& rig;  ///< Model of the plate for simulated devices.
  usb::UsbBus* usb = nullptr;    ///< Required for USB devices; without it their creation fails.
};

using DeviceFactory = std::function<core::Result<std::unique_ptr<Device>>(const DeviceUri&, const DeviceContext&)>;

struct RegistryEntry {
  std::string scheme_and_name;  ///< "sim:floor"
  std::string sentence;         ///< For `dtsctl device list` and error messages.
  DeviceFactory create;
  std::vector<usb::UsbModel> usb_models{};  ///< USB products that it drives; empty: `find_units` does not find them.
};

/// All kinds of devices in this program. A new kind needs one folder and one entry in registry.cpp.
[[nodiscard]] const std::vector<RegistryEntry>& registry();

/// Returns true if both URIs may open the same unit: same kind of hardware, and equal serial numbers or one of them missing.
[[nodiscard]] bool compete(std::string_view one_uri, std::string_view other_uri);

/// Parses `uri` and creates the device, in state Closed. Errors name the URI, the unknown kind or option, and the known ones.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_device(std::string_view uri, const DeviceContext& context);

}  // namespace dts::device
