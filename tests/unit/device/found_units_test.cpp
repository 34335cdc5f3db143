// SPDX-License-Identifier: Apache-2.0
#include "device/found_units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/clock.h"
#include "device/registry.h"
#include "unit/device/sim_rig.h"
#include "usb/emulator/fs_plus_emulator.h"
#include "usb/emulator/u6_emulator.h"
#include "usb/fake/fake_bus.h"

namespace dts::device {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

void silence(double, std::span<double> volts) { std::ranges::fill(volts, 0.0); }

struct FoundUnits : testing::Test {
  core::VirtualClock clock{1'000'000'000};
  emulator::FsPlusEmulator first{emulator::FsPlusKind::Usb1608, "01A2B3C4", silence};
  emulator::FsPlusEmulator second{emulator::FsPlusKind::Usb205, "0BADCAFE", silence};
  emulator::U6Emulator u6{silence};
  emulator::FakeBus bus{clock};

  [[nodiscard]] std::vector<std::string> uris() {
    std::vector<std::string> uris;
    const auto units = find_units(bus).value();
    for (const FoundUnit& found : units) uris.push_back(found.uri);
    return uris;
  }
};

TEST_F(FoundUnits, NothingPluggedIn_NothingFound) { EXPECT_THAT(uris(), IsEmpty()); }

TEST_F(FoundUnits, EveryUnitIsListedOnceWithTheAddressToWrite) {
  bus.plug(first);
  bus.plug(second);
  bus.plug(u6);

  EXPECT_THAT(uris(), ElementsAre("mcc:1608fs-plus?serial=01A2B3C4", "mcc:usb-205?serial=0BADCAFE", "labjack:u6"));
  EXPECT_EQ(find_units(bus).value()[0].model, "USB-1608FS-Plus");
}

TEST_F(FoundUnits, TheAddressOpensTheUnitWhichThenSaysItsNode) {
  bus.plug(first);
  const physics::RigModel rig = test::floor_rig();
  const FoundUnit found = find_units(bus).value()[0];
  const auto device = create_device(found.uri, {clock, rig, &bus}).value();

  EXPECT_THAT(device->report().nodes, IsEmpty());
  ASSERT_TRUE(device->open().has_value());
  EXPECT_THAT(device->report().nodes, ElementsAre(found.unit.node()));
  ASSERT_TRUE(device->close().has_value());
  EXPECT_THAT(device->report().nodes, IsEmpty());
}

TEST(IsMeantBy, ModelAndSerialNumberDecide) {
  FoundUnit unit;
  unit.unit.serial = "01AB";
  unit.model = "USB-1608FS-Plus";
  unit.uri = "mcc:1608fs-plus?serial=01AB";
  EXPECT_TRUE(is_meant_by(unit, "mcc:1608fs-plus?channels=0,1"));
  EXPECT_TRUE(is_meant_by(unit, "mcc:1608fs-plus?serial=01AB"));
  EXPECT_FALSE(is_meant_by(unit, "mcc:1608fs-plus?serial=02CD"));
  EXPECT_TRUE(is_meant_by(unit, "mcc:1608fs-plus-pair?serial=02CD&second_serial=01AB"));
  EXPECT_FALSE(is_meant_by(unit, "mcc:1608g?fpga=x"));
  EXPECT_FALSE(is_meant_by(unit, "sim:floor"));
}

}  // namespace
}  // namespace dts::device
