// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>

#include "core/clock.h"
#include "device/registry.h"
#include "unit/device/sim_rig.h"
#include "usb/nidaqmx_stub/nidaqmx_stub.h"

namespace dts::device::nidaqmx::test {

inline constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
inline constexpr std::int64_t kSecond = 1000 * kMillisecond;
inline const std::string kLibrary = std::string("library=") + DTS_NIDAQMX_STUB;

/// The same library that the device loads: it is loaded once per process.
inline emulator::NiStubControl& stub() {
  void* const library = dlopen(DTS_NIDAQMX_STUB, RTLD_NOW | RTLD_LOCAL);
  EXPECT_NE(library, nullptr);
  return *reinterpret_cast<emulator::NiStubControl* (*)()>(dlsym(library, "nidaqmx_stub_control"))();
}

struct Rig {
  explicit Rig(const std::string& options = "channels=0,1,2,3", const std::string& name = "Dev1") : control(stub()) {
    control = {};
    control.now_ns = [this] { return clock.now_ns(); };
    control.wait_until_ns = [this](std::int64_t time_ns) { clock.sleep_until_ns(time_ns); };
    auto created = create_device("ni:" + name + "?" + options + (options.empty() ? "" : "&") + kLibrary, {clock, plate});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    if (created) device = std::move(*created);
  }
  ~Rig() {
    device.reset();
    EXPECT_EQ(control.tasks, 0);
    control = {};
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  void start(double rate_hz, std::size_t block_scans = 64) {
    const auto opened = device->open();
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
    const auto started = device->start({device::test::rate_of(rate_hz), block_scans});
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
    block = core::Block(device->describe().channels.size(), block_scans);
  }

  ReadResult read(std::int64_t patience_ns = kSecond) { return device->read(block, clock.now_ns() + patience_ns); }

  core::VirtualClock clock{1000 * kSecond};
  physics::RigModel plate = device::test::floor_rig();
  emulator::NiStubControl& control;
  std::unique_ptr<Device> device;
  core::Block block;
};

inline core::Error open_error(Device& device) {
  const auto opened = device.open();
  EXPECT_FALSE(opened.has_value());
  EXPECT_EQ(device.state(), DeviceState::Closed);
  return opened ? core::Error{} : opened.error();
}

inline core::Error start_error(Rig& rig, double rate_hz) {
  EXPECT_TRUE(rig.device->open().has_value());
  const auto started = rig.device->start({device::test::rate_of(rate_hz), 64});
  EXPECT_FALSE(started.has_value());
  EXPECT_EQ(rig.control.tasks, 0);
  return started ? core::Error{} : started.error();
}

}  // namespace dts::device::nidaqmx::test
