// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/standard_requests.h"

#include <string>

namespace dts::emulator {
namespace {

constexpr std::uint8_t kTypeBits = 0x60;  // of bmRequestType; 0: standard
constexpr std::uint8_t kEndpointDescriptor = 5;
constexpr std::size_t kFallbackPacketBytes = 64;

constexpr ControlReply stalled() { return {ReplyKind::Stall, {}}; }

ControlReply string_descriptor(const Descriptors& descriptors, std::size_t index) {
  if (index == 0) return {ReplyKind::Done, {4, 3, 0x09, 0x04}};  // languages: English (United States)
  if (index > descriptors.strings.size()) return stalled();
  ControlReply reply{ReplyKind::Done, {0, 3}};
  for (const char letter : descriptors.strings[index - 1]) {
    reply.data.push_back(static_cast<std::uint8_t>(letter));
    reply.data.push_back(0);
  }
  reply.data[0] = static_cast<std::uint8_t>(reply.data.size());
  return reply;
}

ControlReply descriptor(const Descriptors& descriptors, const Setup& setup) {
  switch (setup.value >> 8) {
    case 1: return {ReplyKind::Done, descriptors.device};
    case 2: return {ReplyKind::Done, descriptors.configuration};
    case 3: return string_descriptor(descriptors, setup.value & 0xff);
    case 6:  // device qualifier: a device of full speed only has none
      if (!descriptors.is_high_speed) return stalled();
      return {ReplyKind::Done, {10, 6, 0x00, 0x02, 0xff, 0, 0, 64, 1, 0}};
    default: return stalled();
  }
}

}  // namespace

std::optional<ControlReply> standard_reply(const Descriptors& descriptors, const Setup& setup) {
  if ((setup.request_type & kTypeBits) != 0) return std::nullopt;
  ControlReply reply;
  switch (setup.request) {
    case 0: reply.data = {0, 0}; break;                     // GET_STATUS
    case 6: reply = descriptor(descriptors, setup); break;  // GET_DESCRIPTOR
    case 8: reply.data = {1}; break;                        // GET_CONFIGURATION
    case 10: reply.data = {0}; break;                       // GET_INTERFACE
    case 1:
    case 3:
    case 5:
    case 9:
    case 11: break;  // features, address, configuration, interface
    default: reply = stalled(); break;
  }
  if (reply.data.size() > setup.length) reply.data.resize(setup.length);
  return reply;
}

std::optional<std::uint8_t> halt_cleared_by(const Setup& setup) {
  if (setup.request_type != 0x02 || setup.request != 1 || setup.value != 0) return std::nullopt;
  return static_cast<std::uint8_t>(setup.index & 0xff);
}

std::size_t packet_bytes_of(const Descriptors& descriptors, std::uint8_t endpoint) {
  const auto& bytes = descriptors.configuration;
  for (std::size_t i = 0; i + 1 < bytes.size() && bytes[i] >= 2; i += bytes[i]) {
    const bool is_it = bytes[i + 1] == kEndpointDescriptor && i + 6 < bytes.size() && bytes[i + 2] == endpoint;
    if (is_it) return static_cast<std::size_t>(bytes[i + 4] | bytes[i + 5] << 8) & 0x7ff;
  }
  return kFallbackPacketBytes;
}

}  // namespace dts::emulator
