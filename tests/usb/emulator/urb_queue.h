// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "device/usb/usb_status.h"
#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// A finished bulk IN transfer.
struct FinishedUrb {
  std::uint64_t id = 0;
  device::usb::UsbStatus status = device::usb::UsbStatus::Completed;
  std::vector<std::uint8_t> bytes;
};

/// What a host controller does with bulk IN transfers of one endpoint: packets of the device fill the oldest transfer, which ends
/// when it is full, by a short packet, by a stall (all waiting ones stall until the halt is cleared) or by a packet that does not fit.
class UrbQueue {
 public:
  UrbQueue(std::uint8_t endpoint, std::size_t packet_bytes) : endpoint_(endpoint), packet_bytes_(packet_bytes) {}

  void submit(std::uint64_t id, std::size_t capacity);
  /// nullopt: not here (already finished). What it held goes with it.
  [[nodiscard]] std::optional<FinishedUrb> cancel(std::uint64_t id);
  /// Every waiting transfer ends with `status`: the device is gone.
  [[nodiscard]] std::vector<FinishedUrb> end_all(device::usb::UsbStatus status);
  /// Takes packets from the device as long as it has some and a transfer waits.
  [[nodiscard]] std::vector<FinishedUrb> advance(EmulatedDevice& device, std::int64_t now_ns);
  void clear_halt() noexcept { is_halted_ = false; }
  [[nodiscard]] bool is_waiting() const noexcept { return !urbs_.empty(); }
  [[nodiscard]] std::uint8_t endpoint() const noexcept { return endpoint_; }

 private:
  struct Urb {
    std::uint64_t id = 0;
    std::size_t capacity = 0;
    std::vector<std::uint8_t> bytes;
  };
  /// The packet goes into the oldest transfer; its status when that ends it.
  [[nodiscard]] std::optional<device::usb::UsbStatus> take(const std::vector<std::uint8_t>& packet);

  std::uint8_t endpoint_;
  std::size_t packet_bytes_;
  std::deque<Urb> urbs_;
  bool is_halted_ = false;
};

}  // namespace dts::emulator
