// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libusb-1.0/libusb.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "device/usb/usb_port.h"

namespace dts::device::usb {

/// An open libusb handle and the transfers that somebody waits for. libusb's own synchronous calls may handle events in the caller's
/// thread, and with them the callbacks of a running stream; here every callback runs in the event thread.
///
///     caller: submit --> event thread: on_waited, ring --> caller: result
///
/// Thread: any but the event thread; calls are made one after the other.
class LibusbHandle {
 public:
  /// Takes an open handle over and closes it at the end.
  explicit LibusbHandle(libusb_device_handle* handle) noexcept : handle_(handle) {}
  ~LibusbHandle() { close(); }
  LibusbHandle(const LibusbHandle&) = delete;
  LibusbHandle& operator=(const LibusbHandle&) = delete;

  [[nodiscard]] libusb_device_handle* get() const noexcept { return handle_; }
  /// No callback of any transfer comes after this. Idempotent.
  void close() noexcept;

  /// What goes out and where what comes in belongs: one of them is empty, or both.
  struct Data {
    std::span<const std::uint8_t> sent;
    std::span<std::uint8_t> received;
  };
  /// Any control request; bit 7 of `type` is its direction. Returns within `timeout_ms` and two seconds of grace.
  [[nodiscard]] UsbResult control(std::uint8_t type, const ControlRequest& request, const Data& data, int timeout_ms);
  /// Bit 7 of `endpoint` is the direction. As `control`.
  [[nodiscard]] UsbResult bulk(std::uint8_t endpoint, const Data& data, int timeout_ms);
  /// A string of the device, ASCII only; empty: it has none or does not answer.
  [[nodiscard]] std::string string_descriptor(std::uint8_t index, int timeout_ms);

 private:
  struct Waited;
  static void on_waited(libusb_transfer* transfer);
  [[nodiscard]] UsbResult run(std::unique_ptr<Waited> waited, std::span<std::uint8_t> received, std::size_t offset, int timeout_ms);

  libusb_device_handle* handle_;
  std::mutex mutex_;  ///< One waited-for transfer at a time.
};

}  // namespace dts::device::usb
