// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/clock.h"
#include "device/usb/usb_bus.h"
#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// A USB bus inside the test, with a virtual clock: time passes only when somebody waits, and everything happens in the waiting
/// thread, in an order that is the same in every run. Hours of streaming take seconds. Thread: one.
class FakeBus final : public device::usb::UsbBus {
 public:
  explicit FakeBus(core::VirtualClock& clock) : clock_(clock) {}
  ~FakeBus() override;

  /// `device` outlives the bus or is unplugged before.
  void plug(EmulatedDevice& device);
  /// Transfers in flight end with NoDevice; open ports stay, every call on them says NoDevice.
  void unplug(EmulatedDevice& device);

  /// How late a completion is noticed by the host, ns, asked for every completion: scheduling noise.
  std::function<std::int64_t()> lateness_ns;
  /// Opening fails as if another program had the device.
  bool is_busy = false;
  /// Opening fails as if the udev rule were missing.
  bool is_forbidden = false;
  /// From now on submitting fails with NoDevice without notice of departure: either order happens with real hardware.
  bool refuses_submit = false;
  /// Cancelled transfers never come back: what a broken host controller does.
  bool swallows_cancel = false;
  [[nodiscard]] int transfers_in_flight() const;  ///< 0 when nothing was leaked.
  [[nodiscard]] int open_ports() const;

  [[nodiscard]] core::Result<std::vector<device::usb::UsbUnit>> units(std::span<const device::usb::UsbModel> models) override;
  [[nodiscard]] core::Result<std::unique_ptr<device::usb::UsbPort>> open(const device::usb::UsbUnit& unit) override;
  [[nodiscard]] std::uint64_t arrivals() const noexcept override { return arrivals_; }

 private:
  core::VirtualClock& clock_;
  std::uint64_t arrivals_ = 0;
  // ... as the implementation needs.
};

}  // namespace dts::emulator
