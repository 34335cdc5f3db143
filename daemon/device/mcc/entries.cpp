// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/entries.h"

#include <string>

#include "device/mcc/fs_plus.h"
#include "device/mcc/joined_pair.h"
#include "device/mcc/usb1608g.h"

namespace dts::device::mcc {

std::vector<RegistryEntry> registry_entries() {
  std::vector<RegistryEntry> entries;
  for (const FsPlusModel& model : fs_plus_models()) {
    const std::string kind = model.is_simultaneous ? " simultaneous inputs" : " inputs";
    entries.push_back({std::string(model.usb.uri),
                       "MCC " + std::string(model.usb.name) + ": 8" + kind + ", " + std::to_string(model.bits) + " bits.",
                       [&model](const DeviceUri& uri, const DeviceContext& context) { return create_fs_plus(model, uri, context); },
                       {model.usb}});
  }
  for (const Usb1608gModel& model : usb_1608g_models()) {
    const usb::UsbModel& first = model.revisions.front();
    entries.push_back({std::string(first.uri),
                       "MCC " + std::string(first.name) + ": 16 inputs, 16 bits, needs an FPGA image.",
                       [&model](const DeviceUri& uri, const DeviceContext& context) { return create_usb_1608g(model, uri, context); },
                       {model.revisions.begin(), model.revisions.end()}});
  }
  // No USB products here: a plugged-in unit must be listed once, as a single unit.
  entries.push_back({"mcc:1608fs-plus-pair", "Two USB-1608FS-Plus joined by SYNC: 16 simultaneous inputs.", create_pair});
  return entries;
}

}  // namespace dts::device::mcc
