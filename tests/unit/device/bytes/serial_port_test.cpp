// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/serial_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <termios.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "device/bytes/raw_mode.h"
#include "support/allocation_counter.h"
#include "support/temporary_folder.h"
#include "unit/device/bytes/link_ends.h"

namespace dts::device::bytes {
namespace {

using core::ErrorCode;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kBaud = 115200;

struct SerialPortTest : testing::Test {
  core::SystemClock clock;
  Pty pty;
  dts::test::TemporaryFolder folder;

  std::unique_ptr<ByteLink> port(const std::string& path, std::uint32_t baud = kBaud) { return create_serial_port(path, "", baud, clock); }
  std::unique_ptr<ByteLink> opened() {
    auto link = port(pty.path());
    EXPECT_TRUE(link->open().has_value());
    return link;
  }
  /// A folder like /sys and /dev with one USB port, whose node leads to `target`.
  void plug(const std::string& name, const std::string& serial, const std::string& target) {
    namespace fs = std::filesystem;
    const fs::path device = folder.path() + "/sys/devices/usb/" + name;
    fs::create_directories(device / "interface/tty" / name);
    std::ofstream(device / "idVendor") << "2341\n";
    std::ofstream(device / "idProduct") << "0043\n";
    std::ofstream(device / "serial") << serial << '\n';
    fs::create_directories(folder.path() + "/sys/class/tty");
    fs::create_directories(folder.path() + "/dev");
    fs::create_symlink(device / "interface", device / "interface/tty" / name / "device");
    fs::create_symlink(device / "interface/tty" / name, folder.path() + "/sys/class/tty/" + name);
    fs::create_symlink(target, folder.path() + "/dev/" + name);
  }
  void unplug(const std::string& name) {
    std::filesystem::remove(folder.path() + "/sys/class/tty/" + name);
    std::filesystem::remove(folder.path() + "/dev/" + name);
  }
};

TEST_F(SerialPortTest, BytesGoBothWays_AllValuesUnchanged) {
  auto link = opened();
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  pty.say(all);
  EXPECT_EQ(read_text(*link, all.size()), all);
  ASSERT_TRUE(link->write(as_bytes(all)).has_value());
  EXPECT_EQ(pty.heard(all.size()), all);
}

TEST_F(SerialPortTest, ModeIsRaw8N1AtTheWantedBaudRate_AlsoAnOddOne) {
  for (const std::uint32_t baud : {9600U, 115200U, 250000U, 2000000U, 123457U}) {
    auto link = port(pty.path(), baud);
    ASSERT_TRUE(link->open().has_value()) << baud;
    const core::Descriptor same(::open(link->facts().nodes.at(0).c_str(), O_RDWR | O_NOCTTY));
    if (same.get() < 0) GTEST_SKIP() << "only root may look at a port in use";
    termios mode{};
    ASSERT_EQ(tcgetattr(same.get(), &mode), 0);
    EXPECT_EQ(mode.c_iflag, 0U);
    EXPECT_EQ(mode.c_lflag, 0U);
    EXPECT_EQ(mode.c_oflag, 0U);
    EXPECT_EQ(mode.c_cflag & static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB | CLOCAL | CREAD | HUPCL),
              static_cast<tcflag_t>(CS8 | CLOCAL | CREAD));
    EXPECT_EQ(baud_of(same.get()), baud);
  }
}

TEST_F(SerialPortTest, WhatArrivedBeforeOpening_IsDiscarded) {
  {
    auto link = opened();  // leaves the tty in raw mode: it keeps the bytes that follow
  }
  pty.say("old");
  auto link = opened();
  pty.say("new");
  EXPECT_EQ(read_text(*link, 3), "new");
}

TEST_F(SerialPortTest, SilenceEndsWithTimeout) {
  auto link = opened();
  std::array<std::uint8_t, 8> buffer{};
  EXPECT_EQ(link->read(buffer, clock.now_ns() + 1'000'000).end, ReadEnd::Timeout);
  EXPECT_EQ(link->read(buffer, clock.now_ns() - 1).end, ReadEnd::Timeout);
  EXPECT_EQ(link->read(buffer, std::numeric_limits<std::int64_t>::min()).end, ReadEnd::Timeout);
  EXPECT_EQ(link->why_lost(), "");
}

TEST_F(SerialPortTest, InterruptEndsAReadThatWaits_AndOneThatBeginsLater_Once) {
  auto link = opened();
  std::array<std::uint8_t, 8> buffer{};
  link->interrupt();
  EXPECT_EQ(link->read(buffer, clock.now_ns() + kPatienceNs).end, ReadEnd::Interrupted);
  EXPECT_EQ(link->read(buffer, clock.now_ns()).end, ReadEnd::Timeout);
  std::jthread other([&] { link->interrupt(); });
  EXPECT_EQ(link->read(buffer, clock.now_ns() + kPatienceNs).end, ReadEnd::Interrupted);
}

TEST_F(SerialPortTest, ReadAllocatesNothing_AndStampsTheArrival) {
  auto link = opened();
  std::array<std::uint8_t, 8> buffer{};
  pty.say("abc");
  const std::int64_t before_ns = clock.raw_ns();
  const std::uint64_t heap_calls = dts::test::heap_calls_of_this_thread();
  const BytesRead read = link->read(buffer, clock.now_ns() + kPatienceNs);
  EXPECT_EQ(dts::test::heap_calls_of_this_thread(), heap_calls);
  EXPECT_EQ(read.end, ReadEnd::Bytes);
  EXPECT_GE(read.raw_ns, before_ns);
  EXPECT_LE(read.raw_ns, clock.raw_ns());
}

TEST_F(SerialPortTest, UnpluggedPortIsLost_TheLastBytesComeFirst) {
  auto link = opened();
  pty.say("tail");
  EXPECT_EQ(read_text(*link, 4), "tail");
  pty.unplug();
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_THAT(link->why_lost(), HasSubstr("serial port " + pty.path() + " was unplugged"));
  const auto written = link->write(as_bytes("x"));
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::DeviceGone);
}

TEST_F(SerialPortTest, BoardThatTakesNoBytes_WriteEndsWithTimeout) {
  auto link = opened();
  const auto written = link->write(as_bytes(std::string(1'000'000, 'x')));
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::Timeout);
  EXPECT_THAT(written.error().what, HasSubstr("does not take bytes"));
}

TEST_F(SerialPortTest, PortInUse_IsRefused_AndFreeAfterClose) {
  auto first = opened();
  auto second = port(pty.path());
  const auto refused = second->open();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::WrongState);
  EXPECT_THAT(refused.error().what, HasSubstr("another program uses it"));
  first->close();
  first->close();
  EXPECT_TRUE(second->open().has_value());
  EXPECT_TRUE(second->open().has_value()) << "a second open has no effect";
}

TEST_F(SerialPortTest, WrongPaths_AreExplained) {
  EXPECT_EQ(port("/dev/ttyACM-none")->open().error().code, ErrorCode::NotFound);
  EXPECT_EQ(port("/dev/ttyACM-none")->open().error().what, "cannot open serial port /dev/ttyACM-none: it does not exist");
  EXPECT_THAT(port("/dev/ttyACM-none")->open().error().hint, HasSubstr("dtsctl device list"));
  EXPECT_EQ(port("/dev/null")->open().error().code, ErrorCode::InvalidArgument);
  EXPECT_THAT(port("/dev/null")->open().error().what, HasSubstr("is not a serial port"));
}

TEST_F(SerialPortTest, ForbiddenPort_NamesTheGroup) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may open every port";
  ASSERT_EQ(::chmod(pty.path().c_str(), 0), 0);
  const auto refused = port(pty.path())->open();
  EXPECT_EQ(refused.error().code, ErrorCode::NotAllowed);
  EXPECT_THAT(refused.error().hint, HasSubstr("dialout"));
}

TEST_F(SerialPortTest, BoardThatComesBack_HasArrivedOnce) {
  const std::string path = folder.path() + "/port";
  std::filesystem::create_symlink(pty.path(), path);
  auto link = port(path);
  EXPECT_TRUE(link->has_arrived());
  EXPECT_FALSE(link->has_arrived());
  ASSERT_TRUE(link->open().has_value());
  EXPECT_FALSE(link->has_arrived());
  EXPECT_THAT(link->facts().nodes, ElementsAre(pty.path()));
  std::filesystem::remove(path);
  pty.unplug();
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  link->close();
  EXPECT_THAT(link->facts().nodes, IsEmpty());
  EXPECT_FALSE(link->has_arrived());
  const Pty again;
  std::filesystem::create_symlink(again.path(), path);
  EXPECT_TRUE(link->has_arrived());
  EXPECT_FALSE(link->has_arrived());
  ASSERT_TRUE(link->open().has_value());
  again.say("here");
  EXPECT_EQ(read_text(*link, 4), "here");
  EXPECT_EQ(link->why_lost(), "");
}

TEST_F(SerialPortTest, SerialNumberFindsThePortUnderAnotherName) {
  plug("ttyACM0", "OTHER", "/dev/null");
  plug("ttyACM1", "758301", pty.path());
  auto link = create_serial_port(folder.path() + "/dev/ttyACM7", "758301", kBaud, clock, folder.path());
  ASSERT_TRUE(link->open().has_value());
  EXPECT_EQ(link->facts().serial, "758301");
  EXPECT_THAT(link->facts().nodes, ElementsAre(pty.path()));
  unplug("ttyACM1");
  pty.unplug();
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  link->close();
  EXPECT_FALSE(link->has_arrived());
  const auto gone = link->open();
  ASSERT_FALSE(gone.has_value());
  EXPECT_EQ(gone.error().code, ErrorCode::NotFound);
  EXPECT_THAT(gone.error().what, HasSubstr("no port has the USB serial number 758301"));
  const Pty again;
  plug("ttyACM2", "758301", again.path());
  EXPECT_TRUE(link->has_arrived());
  ASSERT_TRUE(link->open().has_value());
  EXPECT_THAT(link->facts().nodes, ElementsAre(again.path()));
}

TEST_F(SerialPortTest, OtherUnitAtTheName_IsNotOpened_ButItsByIdLinkIs) {
  const std::string node = folder.path() + "/nodes/ttyACM0";
  std::filesystem::create_directories(folder.path() + "/nodes");
  std::ofstream(node) << "no tty";  // an open port is refused as no serial port
  plug("ttyACM0", "OTHER", node);
  auto link = create_serial_port(folder.path() + "/dev/ttyACM0", "758301", kBaud, clock, folder.path());
  EXPECT_FALSE(link->has_arrived());
  const auto refused = link->open();
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::NotFound);
  EXPECT_THAT(refused.error().what, AllOf(HasSubstr("has the USB serial number OTHER"), HasSubstr("serial=758301")));
  EXPECT_THAT(refused.error().hint, HasSubstr("/dev/serial/by-id"));

  const std::string by_id = folder.path() + "/dev/serial/by-id";
  std::filesystem::create_directories(by_id);
  std::filesystem::create_symlink("../../ttyACM0", by_id + "/usb-OTHER-if00");
  const auto tried = create_serial_port(by_id + "/usb-OTHER-if00", "758301", kBaud, clock, folder.path())->open();
  ASSERT_FALSE(tried.has_value());
  EXPECT_THAT(tried.error().what, HasSubstr("is not a serial port"));

  std::ofstream(folder.path() + "/sys/devices/usb/ttyACM0/serial") << '\n';
  const auto unknown = link->open();
  ASSERT_FALSE(unknown.has_value());
  EXPECT_THAT(unknown.error().what, HasSubstr("is not a serial port")) << "an adapter without a number: the board says who it is";
}

TEST_F(SerialPortTest, BoardThatTakesNoBytes_CloseDiscardsThem) {
  auto link = opened();
  constexpr std::size_t kAll = 1'000'000;
  ASSERT_FALSE(link->write(as_bytes(std::string(kAll, 'x'))).has_value());
  link->close();
  EXPECT_LT(pty.waiting(), 8192U) << "only what the other end had taken: its line discipline holds 4 KiB";
}

TEST_F(SerialPortTest, UnknownSerialNumber_UsesThePath_ForItMayBeTheBoardsOwn) {
  auto link = create_serial_port(pty.path(), "DTS-0001", kBaud, clock, folder.path());
  ASSERT_TRUE(link->open().has_value());
  EXPECT_EQ(link->facts().serial, "");
}

}  // namespace
}  // namespace dts::device::bytes
