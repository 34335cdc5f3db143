// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// The identity of an MCC device: one vendor specific interface with the bulk endpoints given. Texts, power and class are assumed:
/// no descriptor dump of these devices is public.
struct MccIdentity {
  std::uint16_t product = 0;
  std::uint16_t release_bcd = 0x0101;
  std::string name;    ///< "USB-1608FS-Plus"
  std::string serial;  ///< Up to 8 hexadecimal digits.
  bool is_high_speed = false;
  std::uint8_t in_endpoint = 0x81;
  std::uint8_t out_endpoint = 0;  ///< 0: none.
};

[[nodiscard]] Descriptors mcc_descriptors(const MccIdentity& identity);

}  // namespace dts::emulator
