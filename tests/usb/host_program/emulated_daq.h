// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"
#include "usb/emulator/emulated_device.h"
#include "usb/emulator/faults.h"

namespace dts::emulator {

/// A DAQ by name, with its faults.
struct EmulatedDaq {
  std::unique_ptr<EmulatedDevice> device;
  Faults* faults = nullptr;  ///< Inside `device`.
  /// Wires a digital output to an analogue input: 0 or 5 V; empty: this emulation cannot.
  std::function<void(unsigned bit, std::size_t input)> loop_back{};
};

/// "1608fs-plus", "1208fs-plus", "1408fs-plus", "usb-201", "usb-202", "usb-204", "usb-205", "1608g", "u6". `serial` empty: any.
/// InvalidArgument: no such name; the hint lists them.
[[nodiscard]] core::Result<EmulatedDaq> create_daq(std::string_view name, const std::string& serial, Source source);

/// Names that `set_fault` knows, separated by commas.
[[nodiscard]] std::string fault_names();
/// Sets a fault by its name in Faults ("stall_at_code") to a number; false: there is none of that name.
[[nodiscard]] bool set_fault(Faults& faults, std::string_view name, double value);

}  // namespace dts::emulator
