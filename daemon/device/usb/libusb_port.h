// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/log.h"
#include "device/usb/libusb_handle.h"
#include "device/usb/usb_port.h"

namespace dts::device::usb {

/// One open device through libusb; only LibusbBus creates it.
///
///     submit --> libusb ... event thread: on_finished: stamp, listener, ring --> wait
///
/// A transfer counts as in flight until the end of its callback, so `release_transfers` never frees a transfer that the event
/// thread still uses. The code in the callback does not allocate or lock; libusb does, around it and inside submit.
class LibusbPort final : public UsbPort {
 public:
  /// Owns `handle`, an open handle of `device`. Calls `on_closed` at the end of the destructor. Throws std::system_error if the process has
  /// no descriptor left.
  LibusbPort(UsbUnit unit, libusb_device* device, libusb_device_handle* handle, core::Clock& clock, core::Log log,
             std::function<void()> on_closed);
  /// Never frees transfers that are still in flight (a mistake of their owner).
  ~LibusbPort() override;
  LibusbPort(const LibusbPort&) = delete;
  LibusbPort& operator=(const LibusbPort&) = delete;

  /// Claims interface 0; detaches a kernel driver that uses it. Fails as `UsbBus::open`.
  [[nodiscard]] core::Status claim();

  [[nodiscard]] const UsbUnit& unit() const noexcept override { return unit_; }
  [[nodiscard]] core::Result<std::size_t> max_packet_bytes(std::uint8_t endpoint) const override;
  [[nodiscard]] bool is_high_speed() const noexcept override;
  [[nodiscard]] UsbResult control_in(const ControlRequest& request, std::span<std::uint8_t> data, int timeout_ms) override;
  [[nodiscard]] UsbResult control_out(const ControlRequest& request, std::span<const std::uint8_t> data, int timeout_ms) override;
  [[nodiscard]] UsbResult bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) override;
  [[nodiscard]] UsbResult bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) override;
  [[nodiscard]] UsbResult clear_halt(std::uint8_t endpoint) override;
  [[nodiscard]] core::Status prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes,
                                               TransferListener& listener) override;
  [[nodiscard]] UsbStatus submit(std::size_t index) noexcept override;
  void cancel(std::size_t index) noexcept override;
  void release_transfers() noexcept override;
  void wait(std::int64_t deadline_ns) noexcept override;

 private:
  struct Prepared;
  static void on_finished(libusb_transfer* transfer);
  [[nodiscard]] bool are_all_over() const noexcept;

  UsbUnit unit_;
  LibusbHandle handle_;  ///< Before the bell: if no descriptor is left for it, the handle is closed again.
  core::Doorbell bell_;
  libusb_device* device_;
  core::Clock& clock_;
  core::Log log_;
  std::function<void()> on_closed_;
  bool is_claimed_ = false;
  TransferListener* listener_ = nullptr;
  std::vector<std::unique_ptr<Prepared>> prepared_;
};

}  // namespace dts::device::usb
