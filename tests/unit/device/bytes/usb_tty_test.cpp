// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/usb_tty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/temporary_folder.h"

namespace dts::device::bytes {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

struct UsbTtys : testing::Test {
  dts::test::TemporaryFolder folder;

  void attribute(const fs::path& device, const std::string& name, const std::string& text) { std::ofstream(device / name) << text << '\n'; }
  /// A port as the kernel shows it; `steps`: folders between the port and its USB device (CDC: 1, USB serial adapters: 2).
  fs::path plug(const std::string& name, const std::string& vendor, const std::string& product, const std::string& steps = "1-1:1.0") {
    const fs::path device = folder.path() + "/sys/devices/pci0/usb1/" + name;
    const fs::path interface = device / steps;
    fs::create_directories(interface / "tty" / name);
    attribute(device, "idVendor", vendor);
    attribute(device, "idProduct", product);
    fs::create_directories(folder.path() + "/sys/class/tty");
    fs::create_symlink(interface, interface / "tty" / name / "device");
    fs::create_symlink(interface / "tty" / name, folder.path() + "/sys/class/tty/" + name);
    return device;
  }
  void pc_port(const std::string& name) {
    const fs::path port = folder.path() + "/sys/devices/platform/serial8250/tty/" + name;
    fs::create_directories(port);
    fs::create_directories(folder.path() + "/sys/class/tty");
    fs::create_symlink("../../../serial8250", port / "device");
    fs::create_symlink(port, folder.path() + "/sys/class/tty/" + name);
  }
};

TEST_F(UsbTtys, NoSysfs_NoPorts) { EXPECT_THAT(usb_ttys(folder.path()), IsEmpty()); }

TEST_F(UsbTtys, PortsOfUsbDevicesInTheirOrder_NotThoseOfThePc) {
  pc_port("ttyS0");
  fs::create_directories(folder.path() + "/sys/devices/virtual/tty/tty1");
  plug("ttyACM10", "2341", "0043");
  plug("ttyACM2", "2341", "0043");
  fs::create_symlink(folder.path() + "/sys/devices/virtual/tty/tty1", folder.path() + "/sys/class/tty/tty1");
  const fs::path nano = plug("ttyUSB0", "1a86", "7523", "1-2:1.0/ttyUSB0");
  attribute(nano, "product", "USB Serial");
  std::vector<std::string> names;
  for (const UsbTty& tty : usb_ttys(folder.path())) names.push_back(tty.name);
  EXPECT_THAT(names, ElementsAre("ttyACM2", "ttyACM10", "ttyUSB0"));
}

TEST_F(UsbTtys, TextsAndTheLinkByIdentity) {
  const fs::path uno = plug("ttyACM0", "2341", "0043");
  attribute(uno, "manufacturer", "Arduino (www.arduino.cc)");
  attribute(uno, "product", "Uno\x1b[2J");
  attribute(uno, "serial", "7583033393535170A0B1");
  fs::create_directories(folder.path() + "/dev/serial/by-id");
  fs::create_symlink("../../ttyACM0", folder.path() + "/dev/serial/by-id/usb-Arduino_7583033393535170A0B1-if00");
  fs::create_symlink("../../ttyACM1", folder.path() + "/dev/serial/by-id/usb-Another-if00");
  const auto ttys = usb_ttys(folder.path());
  ASSERT_EQ(ttys.size(), 1U);
  EXPECT_EQ(ttys[0].vendor, 0x2341);
  EXPECT_EQ(ttys[0].product, 0x0043);
  EXPECT_EQ(ttys[0].product_name, "Uno [2J") << "a device cannot control the terminal";
  EXPECT_EQ(ttys[0].serial, "7583033393535170A0B1");
  EXPECT_EQ(ttys[0].by_id, "/dev/serial/by-id/usb-Arduino_7583033393535170A0B1-if00");
  EXPECT_EQ(ttys[0].node(), "/dev/ttyACM0");
}

TEST_F(UsbTtys, PortWithoutUsbIdentifiers_IsNotListed) {
  const fs::path broken = plug("ttyACM0", "zz", "0043");
  EXPECT_THAT(usb_ttys(folder.path()), IsEmpty());
  attribute(broken, "idVendor", "2341");
  EXPECT_EQ(usb_ttys(folder.path()).size(), 1U);
}

TEST(KnownBoard, OnlyWhatTheIdentifiersSay) {
  EXPECT_EQ(known_board(0x2341, 0x0043), "Arduino Uno R3");
  EXPECT_EQ(known_board(0x16c0, 0x0483), "Teensy");
  EXPECT_EQ(known_board(0x1a86, 0x7523), "board with CH340 adapter (many Nano and Uno copies)");
  EXPECT_EQ(known_board(0x1234, 0x0043), "");
}

}  // namespace
}  // namespace dts::device::bytes
