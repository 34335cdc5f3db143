// SPDX-License-Identifier: Apache-2.0
#include "device/usb/usb_port.h"

#include <array>
#include <cstdio>

namespace dts::device::usb {

std::string UsbUnit::node() const {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "/dev/bus/usb/%03u/%03u", unsigned{bus}, unsigned{address});
  return text.data();
}

}  // namespace dts::device::usb
