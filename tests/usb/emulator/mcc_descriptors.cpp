// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/mcc_descriptors.h"

#include <vector>

#include "usb/emulator/byte_parts.h"

namespace dts::emulator {
namespace {

constexpr std::uint16_t kVendor = 0x09DB;
constexpr std::uint8_t kVendorSpecific = 0xFF;

void append_endpoint(std::vector<std::uint8_t>& bytes, std::uint8_t address, unsigned packet_bytes) {
  bytes.insert(bytes.end(), {7, 5, address, 2, low_byte(packet_bytes), high_byte(packet_bytes), 0});
}

}  // namespace

Descriptors mcc_descriptors(const MccIdentity& identity) {
  const unsigned usb_version = identity.is_high_speed ? 0x0200 : 0x0110;
  const unsigned packet_bytes = identity.is_high_speed ? 512 : 64;
  const std::uint8_t endpoints = identity.out_endpoint == 0 ? 1 : 2;
  const unsigned total = 9U + 9U + 7U * endpoints;

  Descriptors descriptors;
  descriptors.device = {18,
                        1,
                        low_byte(usb_version),
                        high_byte(usb_version),
                        0,
                        0,
                        0,
                        64,
                        low_byte(kVendor),
                        high_byte(kVendor),
                        low_byte(identity.product),
                        high_byte(identity.product),
                        low_byte(identity.release_bcd),
                        high_byte(identity.release_bcd),
                        1,
                        2,
                        3,
                        1};
  descriptors.configuration = {9, 2, low_byte(total), high_byte(total), 1, 1, 0, 0x80, 250};
  descriptors.configuration.insert(descriptors.configuration.end(), {9, 4, 0, 0, endpoints, kVendorSpecific, 0, 0, 0});
  append_endpoint(descriptors.configuration, identity.in_endpoint, packet_bytes);
  if (identity.out_endpoint != 0) append_endpoint(descriptors.configuration, identity.out_endpoint, packet_bytes);
  descriptors.strings = {"MCC", identity.name, identity.serial};
  descriptors.is_high_speed = identity.is_high_speed;
  return descriptors;
}

}  // namespace dts::emulator
