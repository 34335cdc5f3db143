// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/result.h"
#include "device/device.h"
#include "device/device_uri.h"
#include "device/program_rights.h"
#include "device/usb/usb_bus.h"

namespace dts::physics {
struct RigModel;
}

namespace dts::device {

/// Objects that a factory may use. All of them must outlive the device.
struct DeviceContext {
  core::Clock& clock;
  const physics::RigModel& rig;  ///< Model of the plate for simulated devices.
  usb::UsbBus* usb = nullptr;    ///< Required for USB devices; without it their creation fails.
  ProgramRights programs{};      ///< For devices that start a program.
};

using DeviceFactory = std::function<core::Result<std::unique_ptr<Device>>(const DeviceUri&, const DeviceContext&)>;

/// One kind of device, as its folder offers it to the registry.
struct RegistryEntry {
  std::string scheme_and_name;  ///< "sim:floor"
  std::string sentence;         ///< For `dtsctl device list` and error messages.
  DeviceFactory create;
  std::vector<usb::UsbModel> usb_models{};  ///< USB products that it drives; empty: `find_units` does not find them.
};

}  // namespace dts::device
