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

/// An open libusb handle and its synchronous transfers. The synchronous calls of libusb may handle events, and so run the callbacks of
/// a stream, in the caller's thread; here every callback runs in the event thread.
///
///     caller: submit --> event thread: on_waited, ring --> caller: result
///
/// Thread: any but the event thread; calls are made one after the other.
class LibusbHandle {
 public:
  /// Owns an open handle and closes it in the destructor.
  explicit LibusbHandle(libusb_device_handle* handle) noexcept : handle_(handle) {}
  ~LibusbHandle() { close(); }
  LibusbHandle(const LibusbHandle&) = delete;
  LibusbHandle& operator=(const LibusbHandle&) = delete;

  [[nodiscard]] libusb_device_handle* get() const noexcept { return handle_; }
  /// Closes the handle; no callback runs after this. Idempotent.
  void close() noexcept;

  /// Bytes to send, and the buffer for received bytes; at least one of them is empty.
  struct Data {
    std::span<const std::uint8_t> sent;
    std::span<std::uint8_t> received;
  };
  /// Makes any control request; bit 7 of `type` is its direction. Returns within `timeout_ms` + 2 s.
  [[nodiscard]] UsbResult control(std::uint8_t type, const ControlRequest& request, const Data& data, int timeout_ms);
  /// Makes a bulk transfer; bit 7 of `endpoint` is its direction. Same time limit as `control`.
  [[nodiscard]] UsbResult bulk(std::uint8_t endpoint, const Data& data, int timeout_ms);
  /// Returns a string of the device, ASCII only; empty: it has none or does not answer.
  [[nodiscard]] std::string string_descriptor(std::uint8_t index, int timeout_ms);

 private:
  struct Waited;
  [[nodiscard]] static std::unique_ptr<Waited> make_waited(std::size_t bytes);
  static void on_waited(libusb_transfer* transfer);
  [[nodiscard]] UsbResult run(std::unique_ptr<Waited> waited, std::span<std::uint8_t> received, std::size_t offset, int timeout_ms);

  libusb_device_handle* handle_;
  std::mutex mutex_;  ///< Allows only one synchronous transfer at a time.
};

}  // namespace dts::device::usb
