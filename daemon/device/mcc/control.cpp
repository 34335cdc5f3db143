// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/control.h"

#include <algorithm>
#include <array>

#include "device/usb/daq_driver.h"

namespace dts::device::mcc {
namespace {

using usb::UsbStatus;

constexpr int kDrainTimeoutMs = 2;
constexpr int kMostDrainMs = 250;
constexpr int kMostEndRequests = 10;              // one or two frames each
constexpr std::size_t kDrainPackets = 64;         // per read: the largest FIFO needs a few reads
constexpr std::uint8_t kDigitalDirection = 0x00;  // 1: input
constexpr std::uint8_t kDigitalLatch = 0x02;
constexpr char kUnplugHint[] = "unplug the device and plug it in again; if that does not help, try another port or cable";

/// Reads the register, changes one bit, writes it back.
core::Status change_bit(usb::UsbPort& port, std::uint8_t request, unsigned bit, bool is_set, const std::string& what, int timeout_ms) {
  DTS_TRY_ASSIGN(const auto before, get(port, {.request = request}, 1, "reading " + what, timeout_ms));
  const unsigned mask = 1U << bit;
  const unsigned after = is_set ? before.front() | mask : before.front() & ~mask;
  return put(port, {.request = request, .value = static_cast<std::uint16_t>(after)}, "setting " + what, timeout_ms);
}

core::Status clear_halt(usb::UsbPort& port, std::uint8_t endpoint) {
  const usb::UsbResult cleared = port.clear_halt(endpoint);
  if (cleared) return {};
  return tl::make_unexpected(usb::to_error(cleared.error(), "clearing the data endpoint's halt", kUnplugHint));
}

}  // namespace

core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, std::span<const std::uint8_t> bytes, const std::string& what,
                 int timeout_ms) {
  const usb::UsbResult sent = port.control_out(request, bytes, timeout_ms);
  if (!sent) return tl::make_unexpected(usb::to_error(sent.error(), what, kUnplugHint));
  if (*sent == bytes.size()) return {};
  return core::fail(core::ErrorCode::Failed,
                    what + ": the device accepted " + std::to_string(*sent) + " of " + std::to_string(bytes.size()) + " bytes",
                    kUnplugHint);
}

core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what, int timeout_ms) {
  return put(port, request, {}, what, timeout_ms);
}

core::Result<std::vector<std::uint8_t>> get(usb::UsbPort& port, const usb::ControlRequest& request, std::size_t count,
                                            const std::string& what, int timeout_ms) {
  std::vector<std::uint8_t> bytes(count);
  const usb::UsbResult received = port.control_in(request, bytes, timeout_ms);
  if (!received) return tl::make_unexpected(usb::to_error(received.error(), what, kUnplugHint));
  if (*received == count) return bytes;
  return core::fail(core::ErrorCode::DataDamaged,
                    what + ": the device sent " + std::to_string(*received) + " of " + std::to_string(count) + " bytes", kUnplugHint);
}

core::Result<std::uint16_t> get_word(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what, int timeout_ms) {
  return get(port, request, kCodeBytes, what, timeout_ms).map([](const std::vector<std::uint8_t>& bytes) {
    return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8U);
  });
}

core::Status empty_endpoint(usb::UsbPort& port, std::uint8_t endpoint) {
  DTS_TRY_ASSIGN(const auto packet_bytes, port.max_packet_bytes(endpoint));
  DTS_TRY(clear_halt(port, endpoint));
  std::vector<std::uint8_t> bytes(kDrainPackets * packet_bytes);
  // A read lasts at most its timeout, so the number of reads limits the time.
  for (int spent_ms = 0; spent_ms < kMostDrainMs; spent_ms += kDrainTimeoutMs) {
    const usb::UsbResult received = port.bulk_in(endpoint, bytes, kDrainTimeoutMs);
    if (received) continue;
    if (received.error() == UsbStatus::TimedOut) return {};
    if (received.error() == UsbStatus::NoDevice) return tl::make_unexpected(usb::to_error(received.error(), "emptying the data endpoint"));
    // More packets may wait after a halt or a damaged packet.
    if (received.error() != UsbStatus::Stall) continue;
    DTS_TRY(clear_halt(port, endpoint));
  }
  return core::fail(core::ErrorCode::Failed, "emptying the data endpoint: the device still sends data after its scan was stopped",
                    kUnplugHint);
}

core::Status await_end(usb::DaqDriver& driver, usb::UsbPort& port) {
  for (int i = 0; i < kMostEndRequests; ++i) {
    DTS_TRY_ASSIGN(const auto found, driver.health(port));
    if (!found.is_running) return {};
  }
  return core::fail(core::ErrorCode::Failed, driver.describe().uri + " still scans after it was stopped", kUnplugHint);
}

void append_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

core::Status drive_line(usb::UsbPort& port, unsigned bit, bool is_high, int timeout_ms) {
  return change_bit(port, kDigitalLatch, bit, is_high, "digital output " + std::to_string(bit), timeout_ms);
}

core::Status prepare_line(usb::UsbPort& port, unsigned bit, LineDirection direction) {
  // Write the latch first: the line must not output an old level when it becomes an output.
  DTS_TRY(drive_line(port, bit, false, usb::kSetupTimeoutMs));
  const std::string what = "the direction of digital line " + std::to_string(bit);
  if (direction == LineDirection::PerPort) return put(port, {.request = kDigitalDirection, .value = 0}, "setting " + what);
  return change_bit(port, kDigitalDirection, bit, false, what, usb::kSetupTimeoutMs);
}

CodesRead read_codes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes, std::uint16_t largest) noexcept {
  CodesRead read;
  const std::size_t count = std::min(bytes.size() / kCodeBytes, codes.size());
  for (; read.codes < count; ++read.codes) {
    const auto code = static_cast<std::uint16_t>(bytes[read.bytes] | bytes[read.bytes + 1] << 8U);
    read.bytes += kCodeBytes;
    if (code > largest) {
      read.is_damaged = true;
      return read;
    }
    codes[read.codes] = code;
  }
  if (bytes.size() - read.bytes != 1) return read;
  ++read.bytes;
  read.is_damaged = true;
  return read;
}

}  // namespace dts::device::mcc
