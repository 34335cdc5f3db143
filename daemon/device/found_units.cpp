// SPDX-License-Identifier: Apache-2.0
#include "device/found_units.h"

#include <algorithm>

#include "device/registry.h"

namespace dts::device {
namespace {

/// Every product once, by the first device kind that drives it.
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

}  // namespace

core::Result<std::vector<FoundUnit>> find_units(usb::UsbBus& bus) {
  const std::vector<usb::UsbModel> models = known_models();
  auto units = bus.units(models);
  if (!units) return tl::make_unexpected(units.error());
  std::vector<FoundUnit> found;
  for (usb::UsbUnit& unit : *units) {
    const auto model = std::ranges::find_if(
        models, [&](const usb::UsbModel& known) { return known.vendor == unit.vendor && known.product == unit.product; });
    if (model == models.end()) continue;
    std::string uri(model->uri);
    if (!unit.serial.empty()) uri += "?serial=" + unit.serial;
    found.push_back({.unit = std::move(unit), .model = std::string(model->name), .uri = std::move(uri)});
  }
  return found;
}

}  // namespace dts::device
