// SPDX-License-Identifier: Apache-2.0
#include "device/found_units.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "device/registry.h"

namespace dts::device {
namespace {

/// Returns every product once, with the first entry of the registry that drives it.
std::vector<usb::UsbModel> known_models() {
  std::vector<usb::UsbModel> models;
  for (const RegistryEntry& entry : registry()) {
    for (const usb::UsbModel& model : entry.usb_models) {
      const auto is_same = [&](const usb::UsbModel& other) { return other.vendor == model.vendor && other.product == model.product; };
      if (std::ranges::none_of(models, is_same)) models.push_back(model);
    }
  }
  return models;
}

std::string model_of(const bytes::UsbTty& tty) {
  std::array<char, 16> ids{};
  std::snprintf(ids.data(), ids.size(), "%04x:%04x", tty.vendor, tty.product);
  const std::string_view known = bytes::known_board(tty.vendor, tty.product);
  std::string name(known.empty() ? tty.product_name : known);
  if (name.empty()) name = "serial port";
  return name + " (USB " + ids.data() + ", " + tty.node() + ")";
}

}  // namespace

core::Result<std::vector<FoundUnit>> find_units(usb::UsbBus& bus) {
  const std::vector<usb::UsbModel> models = known_models();
  DTS_TRY_ASSIGN(auto units, bus.units(models));
  std::vector<FoundUnit> found;
  for (usb::UsbUnit& unit : units) {
    const auto model = std::ranges::find_if(
        models, [&](const usb::UsbModel& known) { return known.vendor == unit.vendor && known.product == unit.product; });
    if (model == models.end()) continue;
    std::string uri(model->uri);
    if (!unit.serial.empty()) uri += "?serial=" + unit.serial;
    found.push_back({.unit = std::move(unit), .model = std::string(model->name), .uri = std::move(uri)});
  }
  return found;
}

bool is_meant_by(const FoundUnit& unit, const std::string& device_uri) {
  const auto own = DeviceUri::parse(unit.uri);
  const auto wanted = DeviceUri::parse(device_uri);
  // "mcc:1608fs-plus-pair" uses two units of "mcc:1608fs-plus" and has a serial number for each.
  if (!own || !wanted || wanted->scheme != own->scheme || !wanted->name.starts_with(own->name)) return false;
  bool names_serial = false;
  for (const char* option : {"serial", "second_serial"}) {
    const auto serial = wanted->options.find(option);
    if (serial == wanted->options.end()) continue;
    names_serial = true;
    if (serial->second == unit.unit.serial) return true;
  }
  return !names_serial && wanted->name == own->name;
}

std::vector<FoundPort> find_ports(const std::string& root) {
  std::vector<FoundPort> found;
  for (bytes::UsbTty& tty : bytes::usb_ttys(root)) {
    FoundPort port;
    port.model = model_of(tty);
    port.uri = "serial:" + (tty.by_id.empty() ? tty.node() : tty.by_id) + "?channels=N";
    port.tty = std::move(tty);
    found.push_back(std::move(port));
  }
  return found;
}

bool is_meant_by(const FoundPort& port, const std::string& device_uri) {
  const auto wanted = DeviceUri::parse(device_uri);
  if (!wanted || wanted->scheme != "serial") return false;
  const auto serial = wanted->options.find("serial");
  if (serial != wanted->options.end() && !port.tty.serial.empty() && serial->second == port.tty.serial) return true;
  return wanted->name == port.tty.node() || (!port.tty.by_id.empty() && wanted->name == port.tty.by_id);
}

}  // namespace dts::device
