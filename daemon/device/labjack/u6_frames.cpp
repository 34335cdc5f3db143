// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_frames.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "device/usb/daq_driver.h"

namespace dts::device::labjack {
namespace {

using core::ErrorCode;

constexpr std::uint8_t kExtended = 0xF8;
constexpr std::uint8_t kNotUnderstood = 0xB8;  // both bytes of the reply to a command with a wrong checksum
constexpr std::size_t kHeaderBytes = 6;
constexpr int kMostStaleReplies = 3;
constexpr std::string_view kReplugHint = "unplug it and plug it in again; try another cable or port";

std::uint8_t low(unsigned value) noexcept { return static_cast<std::uint8_t>(value & 0xFFU); }

Command normal(std::string_view name, std::uint8_t code) {
  return {.name = name, .bytes = {code, code}, .reply_code = static_cast<std::uint8_t>(code + 1), .reply_bytes = 4, .is_extended = false};
}

/// Makes an extended command; `data` must have an even number of bytes.
Command extended(std::string_view name, std::uint8_t code, std::span<const std::uint8_t> data, std::size_t reply_bytes) {
  std::vector<std::uint8_t> bytes = {0, kExtended, low(static_cast<unsigned>(data.size() / 2)), code};
  const std::uint16_t sum = checksum16(data);
  bytes.push_back(low(sum));
  bytes.push_back(low(sum >> 8U));
  bytes.insert(bytes.end(), data.begin(), data.end());
  bytes[0] = checksum8(std::span(bytes).subspan(1, kHeaderBytes - 1));
  return {.name = name, .bytes = std::move(bytes), .reply_code = code, .reply_bytes = reply_bytes, .is_extended = true};
}

std::string_view meaning(std::uint8_t error) noexcept {
  switch (error) {
    case kErrorStreamActive: return "a stream is running";
    case 49: return "stream table invalid";
    case 50: return "stream configuration invalid";
    case kErrorStreamNotRunning: return "no stream is running";
    case 54: return "converter buffer overflow";
    case 55: return "scans overlap: too fast for these channels";
    case 56: return "samples per packet invalid";
    case 58: return "scan rate invalid";
    default: return "see the U6 data sheet, section 5.3";
  }
}

bool belongs_to(const Command& command, std::span<const std::uint8_t> reply) noexcept {
  if (!command.is_extended) return reply.size() >= 2 && reply[1] == command.reply_code;
  return reply.size() >= 4 && reply[1] == kExtended && reply[3] == command.reply_code;
}

bool is_not_understood(std::span<const std::uint8_t> reply) noexcept {
  return reply.size() >= 2 && reply[0] == kNotUnderstood && reply[1] == kNotUnderstood;
}

tl::unexpected<core::Error> damaged(const Command& command, const std::string& why) {
  return core::fail(ErrorCode::DataDamaged, "LabJack U6: the reply to " + std::string(command.name) + " " + why, std::string(kReplugHint));
}

core::Result<Reply> checked_reply(const Command& command, std::span<const std::uint8_t> reply) {
  if (is_not_understood(reply)) return damaged(command, "reports that the command arrived with a wrong checksum");
  // A reply with an error number may be short; a good reply must be complete.
  if (reply.size() != command.reply_bytes) {
    return damaged(command, "has " + std::to_string(reply.size()) + " bytes, not " + std::to_string(command.reply_bytes));
  }
  if (!belongs_to(command, reply)) return damaged(command, "belongs to another command");
  const bool is_whole = command.is_extended ? has_right_checksums(reply) : reply[0] == checksum8(reply.subspan(1));
  if (!is_whole) return damaged(command, "has a wrong checksum");
  return Reply{{reply.begin(), reply.end()}, reply[command.is_extended ? kHeaderBytes : 2]};
}

}  // namespace

std::uint8_t checksum8(std::span<const std::uint8_t> bytes) noexcept {
  unsigned sum = std::accumulate(bytes.begin(), bytes.end(), 0U);
  sum = sum / 256 + sum % 256;
  return low(sum / 256 + sum % 256);
}

std::uint16_t checksum16(std::span<const std::uint8_t> bytes) noexcept {
  return static_cast<std::uint16_t>(std::accumulate(bytes.begin(), bytes.end(), 0U) & 0xFFFFU);
}

bool has_right_checksums(std::span<const std::uint8_t> extended_frame) noexcept {
  const std::uint16_t sum = checksum16(extended_frame.subspan(kHeaderBytes));
  return extended_frame[4] == low(sum) && extended_frame[5] == low(sum >> 8U) &&
         extended_frame[0] == checksum8(extended_frame.subspan(1, kHeaderBytes - 1));
}

Command read_unit() { return extended("ConfigU6", 0x08, std::array<std::uint8_t, 20>{}, 38); }

Command read_calibration(std::uint8_t block) { return extended("ReadCal", 0x2D, std::array<std::uint8_t, 2>{0, block}, 40); }

Command turn_timers_off() { return extended("ConfigIO", 0x0B, std::array<std::uint8_t, 10>{1}, 16); }

Command configure_stream(const StreamSetup& setup) {
  constexpr std::uint8_t kFastestResolution = 1;
  std::vector<std::uint8_t> data = {low(static_cast<unsigned>(setup.channels.size())),
                                    kFastestResolution,
                                    setup.samples_per_packet,
                                    0,
                                    0,  // settling: automatic
                                    setup.scan_config,
                                    low(setup.interval),
                                    low(static_cast<unsigned>(setup.interval) >> 8U)};
  for (std::size_t i = 0; i < setup.channels.size(); ++i) {
    data.push_back(setup.channels[i]);
    data.push_back(setup.options[i]);
  }
  return extended("StreamConfig", 0x11, data, 8);
}

Command start_stream() { return normal("StreamStart", 0xA8); }
Command stop_stream() { return normal("StreamStop", 0xB0); }

core::Result<Reply> exchange(usb::UsbPort& port, const Command& command, int timeout_ms) {
  const std::string what = "LabJack U6: " + std::string(command.name);
  if (const auto sent = port.bulk_out(kCommandEndpoint, command.bytes, timeout_ms); !sent) {
    return tl::make_unexpected(usb::to_error(sent.error(), what, std::string(kReplugHint)));
  }
  std::array<std::uint8_t, kUsbPacketBytes> buffer{};
  for (int stale = 0;; ++stale) {
    const auto received = port.bulk_in(kReplyEndpoint, buffer, timeout_ms);
    if (!received) return tl::make_unexpected(usb::to_error(received.error(), what, std::string(kReplugHint)));
    const auto reply = std::span(buffer).first(std::min(*received, buffer.size()));
    if (stale == kMostStaleReplies || belongs_to(command, reply) || is_not_understood(reply)) return checked_reply(command, reply);
  }
}

core::Result<Reply> run(usb::UsbPort& port, const Command& command, int timeout_ms) {
  auto reply = exchange(port, command, timeout_ms);
  if (reply && reply->error != 0) return tl::make_unexpected(refused(command.name, reply->error));
  return reply;
}

core::Error refused(std::string_view command, std::uint8_t error) {
  return {ErrorCode::Failed,
          "LabJack U6: " + std::string(command) + " was rejected with error " + std::to_string(error) + " (" + std::string(meaning(error)) +
              ")",
          ""};
}

}  // namespace dts::device::labjack
