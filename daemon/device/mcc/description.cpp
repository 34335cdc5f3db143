// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/description.h"

#include <cmath>
#include <string>

#include "device/mcc/fs_plus_models.h"
#include "device/mcc/usb1608g.h"

namespace dts::device::mcc {

std::vector<usb::UsbModel> all_models() {
  std::vector<usb::UsbModel> models;
  for (const FsPlusModel& model : fs_plus_models()) models.push_back(model.usb);
  for (const Usb1608gModel& model : usb_1608g_models()) models.insert(models.end(), model.revisions.begin(), model.revisions.end());
  return models;
}

DeviceDescription describe_unit(std::string_view product, const usb::DaqOptions& options, unsigned bits, double max_scan_hz) {
  DeviceDescription description;
  description.uri = options.uri;
  description.model = "MCC " + std::string(product);
  description.serial = options.serial;
  description.minimum_rate_hz = kMinimumScanHz;
  description.maximum_rate_hz = max_scan_hz;
  for (std::size_t position = 0; position < options.channels.size(); ++position) {
    const bool is_marker = options.marker && options.marker->position == position;
    const double range_v = options.ranges_v[position];
    description.channels.push_back({.name = "ch" + std::to_string(options.channels[position]),
                                    .unit = "V",
                                    .role = is_marker ? ChannelRole::Marker : ChannelRole::Sensor,
                                    .minimum = -range_v,
                                    .maximum = range_v,
                                    .resolution = std::ldexp(2.0 * range_v, -static_cast<int>(bits))});
  }
  return description;
}

}  // namespace dts::device::mcc
