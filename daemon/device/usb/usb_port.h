// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/result.h"
#include "device/usb/usb_status.h"

namespace dts::device::usb {

/// One physical device on the bus.
struct UsbUnit {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t release_bcd = 0;  ///< bcdDevice; MCC: firmware version.
  std::uint8_t bus = 0;
  std::uint8_t address = 0;
  std::string serial;  ///< Empty: it has none, or it could not be read without disturbing another program.

  /// "/dev/bus/usb/001/002"
  [[nodiscard]] std::string node() const;
};

/// A vendor request to the device (bmRequestType 0x40 or 0xC0).
struct ControlRequest {
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// Hears of finished bulk transfers. libusb locks and allocates around the call; what the listener itself does must not.
class TransferListener {
 public:
  /// `bytes` is valid during the call; `stamp_ns` is `Clock::raw_ns` at its start. May submit the transfer again.
  /// Thread: the USB event thread. Must be realtime-safe but for `submit`, and must not wait or call anything else of the port.
  virtual void on_transfer(std::size_t index, UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept = 0;

 protected:
  ~TransferListener() = default;
};

/// One opened device, its interface 0 claimed. The destructor releases and closes; no transfer may be in flight then.
/// Requests and bulk calls wait for their end: not from a listener. Every call on a lost device gives NoDevice.
class UsbPort {
 public:
  virtual ~UsbPort() = default;

  [[nodiscard]] virtual const UsbUnit& unit() const noexcept = 0;
  /// wMaxPacketSize of an endpoint of interface 0; NotFound when it has no such endpoint.
  [[nodiscard]] virtual core::Result<std::size_t> max_packet_bytes(std::uint8_t endpoint) const = 0;
  /// true: a frame is 125 us, not 1 ms.
  [[nodiscard]] virtual bool is_high_speed() const noexcept = 0;

  /// Bytes received, which may be fewer than there is room for. Thread: any but a listener's.
  [[nodiscard]] virtual UsbResult control_in(const ControlRequest& request, std::span<std::uint8_t> data, int timeout_ms) = 0;
  [[nodiscard]] virtual UsbResult control_out(const ControlRequest& request, std::span<const std::uint8_t> data, int timeout_ms) = 0;
  /// A whole number of packets should fit, or a longer packet gives Overflow. TimedOut with nothing received.
  [[nodiscard]] virtual UsbResult bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) = 0;
  [[nodiscard]] virtual UsbResult bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) = 0;
  /// Ends a stall on both sides. Only while no transfer is in flight on the endpoint.
  [[nodiscard]] virtual UsbResult clear_halt(std::uint8_t endpoint) = 0;

  /// Makes `count` bulk IN transfers of `bytes` each, none in flight; replaces earlier ones. `bytes` must be a multiple of
  /// the packet size. The listener must outlive them.
  [[nodiscard]] virtual core::Status prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes,
                                                       TransferListener& listener) = 0;
  /// Puts a prepared transfer that is not in flight into flight; Completed when it is. Realtime-safe: no, libusb takes a lock of
  /// its own and allocates (Linux: the list of URBs of a transfer). On the sample path the event thread alone calls it.
  [[nodiscard]] virtual UsbStatus submit(std::size_t index) noexcept = 0;
  /// Asks for the end of a transfer: the listener hears Cancelled (or how else it ended). Thread: any but a listener's.
  virtual void cancel(std::size_t index) noexcept = 0;
  /// Frees the transfers; only when the listener has heard of the end of every one in flight.
  virtual void release_transfers() noexcept = 0;

  /// Returns when a transfer has finished since the last wait, or at `deadline_ns` (monotonic).
  /// Thread: the one that reads. Realtime-safe: yes.
  virtual void wait(std::int64_t deadline_ns) noexcept = 0;
};

}  // namespace dts::device::usb
