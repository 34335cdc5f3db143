// SPDX-License-Identifier: Apache-2.0
#include "device/registry.h"

#include <gtest/gtest.h>

#include <fstream>

#include <string>

#include "unit/device/sim_rig.h"
#include "usb/fake/fake_bus.h"

namespace dts::device {
namespace {

TEST(Registry, EveryAddressOfTheExampleConfigurationIsAccepted) {
  std::ifstream file(DTS_SOURCE_DIR "/config/dtsd-daq.toml");
  core::VirtualClock clock;
  emulator::FakeBus bus(clock);
  const physics::RigModel rig = test::floor_rig();
  int addresses = 0;
  for (std::string line; std::getline(file, line);) {
    const std::size_t begin = line.find("device = \"");
    if (begin == std::string::npos) continue;
    const std::size_t first = begin + 10;
    const std::string uri = line.substr(first, line.find('"', first) - first);
    const auto device = create_device(uri, {clock, rig, &bus, {.are_allowed = true}});
    const bool lacks_only_the_image = !device && device.error().what.find("usb1608g.bit") != std::string::npos;
    EXPECT_TRUE(device || lacks_only_the_image) << uri << ": " << (device ? "" : core::to_string(device.error()));
    ++addresses;
  }
  EXPECT_EQ(addresses, 11);
}

TEST(Compete, SameKindWithoutTwoSerialNumbers) {
  EXPECT_TRUE(compete("mcc:1608fs-plus", "mcc:1608fs-plus?channels=0"));
  EXPECT_TRUE(compete("mcc:1608fs-plus?serial=A", "mcc:1608fs-plus?serial=A&channels=0"));
  EXPECT_TRUE(compete("ni:Dev1", "ni:Dev1?channels=4"));
  EXPECT_FALSE(compete("mcc:1608fs-plus?serial=A", "mcc:1608fs-plus?serial=B"));
  EXPECT_FALSE(compete("ni:Dev1", "ni:Dev2"));
  EXPECT_FALSE(compete("mcc:1608fs-plus", "labjack:u6"));
  EXPECT_FALSE(compete("sim:floor", "sim:floor"));
}

}  // namespace
}  // namespace dts::device
