// SPDX-License-Identifier: Apache-2.0
#include "device/found_units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/clock.h"
#include "device/registry.h"
#include "support/temporary_folder.h"
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

struct FoundPorts : testing::Test {
  dts::test::TemporaryFolder folder;

  void plug(const std::string& name, const std::string& vendor, const std::string& product, const std::string& serial) {
    namespace fs = std::filesystem;
    const fs::path device = folder.path() + "/sys/devices/usb1/" + name;
    fs::create_directories(device / "interface/tty" / name);
    std::ofstream(device / "idVendor") << vendor;
    std::ofstream(device / "idProduct") << product;
    std::ofstream(device / "serial") << serial;
    std::ofstream(device / "product") << "Serial Thing";
    fs::create_directories(folder.path() + "/sys/class/tty");
    fs::create_directory_symlink(device / "interface", device / "interface/tty" / name / "device");
    fs::create_directory_symlink(device / "interface/tty" / name, folder.path() + "/sys/class/tty/" + name);
  }
};

TEST_F(FoundPorts, ShowBoardIdentifiersAndTheAddressToWrite) {
  plug("ttyACM0", "2341", "0043", "7583");
  plug("ttyUSB3", "abcd", "0001", "");
  std::filesystem::create_directories(folder.path() + "/dev/serial/by-id");
  std::filesystem::create_symlink("../../ttyACM0", folder.path() + "/dev/serial/by-id/usb-Arduino_7583-if00");
  const auto ports = find_ports(folder.path());
  ASSERT_EQ(ports.size(), 2U);
  EXPECT_EQ(ports[0].model, "Arduino Uno R3 (USB 2341:0043, /dev/ttyACM0)");
  EXPECT_EQ(ports[0].uri, "serial:/dev/serial/by-id/usb-Arduino_7583-if00?channels=N");
  EXPECT_EQ(ports[1].model, "Serial Thing (USB abcd:0001, /dev/ttyUSB3)");
  EXPECT_EQ(ports[1].uri, "serial:/dev/ttyUSB3?channels=N");
  EXPECT_TRUE(is_meant_by(ports[0], "serial:/dev/ttyACM0?channels=4"));
  EXPECT_TRUE(is_meant_by(ports[0], "serial:/dev/serial/by-id/usb-Arduino_7583-if00?channels=4"));
  EXPECT_TRUE(is_meant_by(ports[0], "serial:/dev/ttyACM9?channels=4&serial=7583"));
  EXPECT_FALSE(is_meant_by(ports[0], "serial:/dev/ttyACM9?channels=4&serial=7584"));
  EXPECT_FALSE(is_meant_by(ports[1], "serial:/dev/ttyACM9?channels=4&serial="));
  EXPECT_FALSE(is_meant_by(ports[1], "serial:?channels=4"));
  EXPECT_FALSE(is_meant_by(ports[0], "mcc:1608fs-plus?serial=7583"));
}

}  // namespace
}  // namespace dts::device
