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
  std::string serial;  ///< Empty: the unit has none, or it could not be read.

  /// Returns the device file: "/dev/bus/usb/001/002".
  [[nodiscard]] std::string node() const;
};

/// A vendor request to the device (bmRequestType 0x40 or 0xC0).
struct ControlRequest {
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// Called for every finished bulk transfer. libusb locks and allocates around the call; the listener itself must not.
class TransferListener {
 public:
  /// Handles a finished transfer; may submit it again. `bytes` is valid during the call; `stamp_ns` is `Clock::raw_ns` at its start.
  /// Thread: the USB event thread. Must be realtime-safe except for `submit`, must not wait, and must not call other functions of the port.
  virtual void on_transfer(std::size_t index, UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept = 0;

 protected:
  ~TransferListener() = default;
};

/// One open device with its interface 0 claimed. The destructor releases and closes it; no transfer may be in flight then.
/// Requests and bulk calls block until they end: never call them from a listener. Every call on an unplugged device returns NoDevice.
class UsbPort {
 public:
  virtual ~UsbPort() = default;

  [[nodiscard]] virtual const UsbUnit& unit() const noexcept = 0;
  /// Returns wMaxPacketSize of an endpoint of interface 0; fails with NotFound if there is no such endpoint.
  [[nodiscard]] virtual core::Result<std::size_t> max_packet_bytes(std::uint8_t endpoint) const = 0;
  /// Returns true if a frame is 125 us, not 1 ms.
  [[nodiscard]] virtual bool is_high_speed() const noexcept = 0;

  /// Returns the number of received bytes, which may be smaller than `data`. Thread: any but a listener's.
  [[nodiscard]] virtual UsbResult control_in(const ControlRequest& request, std::span<std::uint8_t> data, int timeout_ms) = 0;
  [[nodiscard]] virtual UsbResult control_out(const ControlRequest& request, std::span<const std::uint8_t> data, int timeout_ms) = 0;
  /// Reads bytes. `data` should hold a whole number of packets; otherwise a longer packet causes Overflow. TimedOut: no bytes received.
  [[nodiscard]] virtual UsbResult bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) = 0;
  [[nodiscard]] virtual UsbResult bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) = 0;
  /// Ends a stall on the host and on the device. Only while no transfer is in flight on the endpoint.
  [[nodiscard]] virtual UsbResult clear_halt(std::uint8_t endpoint) = 0;

  /// Makes `count` bulk IN transfers of `bytes` each and replaces earlier transfers; submits none. `bytes` must be a multiple of
  /// the packet size. The listener must outlive the transfers.
  [[nodiscard]] virtual core::Status prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes,
                                                       TransferListener& listener) = 0;
  /// Submits a prepared transfer that is not in flight; returns Completed if it was submitted. Realtime-safe: no, libusb locks its
  /// own mutex and allocates (Linux: the list of URBs of a transfer). On the sample path only the event thread calls it.
  [[nodiscard]] virtual UsbStatus submit(std::size_t index) noexcept = 0;
  /// Requests the end of a transfer; the listener is then called with Cancelled, or with another status if the transfer ended
  /// otherwise. Thread: any but a listener's.
  virtual void cancel(std::size_t index) noexcept = 0;
  /// Frees the transfers. Call it only after the listener was called for the end of every transfer.
  virtual void release_transfers() noexcept = 0;

  /// Waits until a transfer has finished since the last wait, at most until `deadline_ns` (monotonic).
  /// Thread: the one that reads. Realtime-safe: yes.
  virtual void wait(std::int64_t deadline_ns) noexcept = 0;
};

}  // namespace dts::device::usb
