// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "device/usb/libusb_bus.h"
#include "usb/umockdev/counting_device.h"
#include "usb/umockdev/umockdev_host.h"

namespace dts::emulator {

inline constexpr int kTimeoutMs = 60'000;
inline constexpr uid_t kNobody = 65534;
inline constexpr std::chrono::seconds kPatience{60};  ///< Before a test gives up; sanitizers and busy machines are slow.

/// Polls `condition` until it holds or kPatience is over.
[[nodiscard]] inline bool eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < deadline) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

/// A bus in lock-step with its reader, one counting device (not plugged in yet) and the real transport.
class UsbFixture : public ::testing::Test {
 protected:
  explicit UsbFixture(Pace pace = Pace::LockStep) : host_(pace) {}

  void SetUp() override {
    if (!UmockdevHost::is_available()) GTEST_SKIP() << "this program was not linked with libumockdev-preload";
  }

  [[nodiscard]] std::vector<device::usb::UsbUnit> units() {
    static constexpr std::array<device::usb::UsbModel, 1> kModels{
        {{CountingDevice::kVendor, CountingDevice::kProduct, "counting device", "test:counting"}}};
    return bus_.units(kModels).value();
  }
  [[nodiscard]] std::unique_ptr<device::usb::UsbPort> open_port(std::size_t index = 0) { return bus_.open(units().at(index)).value(); }

  CountingDevice device_;
  UmockdevHost host_;
  core::SystemClock clock_;
  device::usb::LibusbBus bus_{clock_, {}, core::Log()};
};

}  // namespace dts::emulator
