// SPDX-License-Identifier: Apache-2.0
#include "usb/umockdev/counting_device.h"

#include <limits>
#include <utility>

namespace dts::emulator {

CountingDevice::CountingDevice(const std::string& serial, bool is_high_speed) {
  const std::uint8_t serial_index = serial.empty() ? 0 : 3;
  descriptors_.is_high_speed = is_high_speed;
  descriptors_.strings = {"dtsd", "counting device", serial};
  descriptors_.device = {18,   1,    0, 2, 0xff,         0, 0, 64, kVendor & 0xff, kVendor >> 8, kProduct & 0xff, kProduct >> 8,
                         0x34, 0x12, 1, 2, serial_index, 1};
  descriptors_.configuration = {
      9, 2, 32, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 2, 0xff, 0, 0, 0, 7, 5, 0x81, 2, kPacketBytes, 0, 0, 7, 5, 0x02, 2, kPacketBytes, 0, 0};
}

void CountingDevice::power_up(std::int64_t) {
  ++power_ups;
  is_running_ = false;
  wants_to_leave_ = false;
  trouble = Trouble::None;
}

ControlReply CountingDevice::control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) {
  if (is_mute) return {ReplyKind::Silence, {}};
  switch (setup.request) {
    case kStart:
      is_running_ = true;
      start_ns_ = now_ns;
      sent_ = 0;
      return {};
    case kStop: is_running_ = false; return {};
    case kEcho:
      if ((setup.request_type & 0x80) != 0) return {ReplyKind::Done, echo_};
      echo_.assign(out_data.begin(), out_data.end());
      return {};
    case kSilent: return {ReplyKind::Silence, {}};
    case kLeave: wants_to_leave_ = true; return {};
    default: return {ReplyKind::Stall, {}};
  }
}

void CountingDevice::bulk_out(std::uint8_t, std::span<const std::uint8_t> bytes, std::int64_t) { bytes_swallowed += bytes.size(); }

std::optional<Packet> CountingDevice::take_packet(std::uint8_t endpoint, std::int64_t now_ns) {
  if (endpoint != 0x81 || !is_running_ || is_mute || now_ns < next_packet_ns(now_ns)) return std::nullopt;
  const Trouble now = std::exchange(trouble, Trouble::None);
  if (now == Trouble::Stall) return Packet{true, {}};
  Packet packet;
  for (std::size_t i = 0; i < kPacketBytes / 2; ++i) {
    const auto code = static_cast<std::uint16_t>(static_cast<std::uint64_t>(sent_) * (kPacketBytes / 2) + i);
    packet.bytes.push_back(static_cast<std::uint8_t>(code & 0xff));
    packet.bytes.push_back(static_cast<std::uint8_t>(code >> 8));
  }
  if (now == Trouble::Short) packet.bytes.resize(10);
  if (now == Trouble::Babble) packet.bytes.resize(kPacketBytes + 2);
  ++sent_;
  return packet;
}

void CountingDevice::clear_halt(std::uint8_t) { ++halts_cleared; }

std::int64_t CountingDevice::next_packet_ns(std::int64_t) const {
  return is_running_ && !is_mute ? start_ns_ + (sent_ + 1) * kPacketNs : std::numeric_limits<std::int64_t>::max();
}

bool CountingDevice::wants_to_leave() { return std::exchange(wants_to_leave_, false); }

}  // namespace dts::emulator
