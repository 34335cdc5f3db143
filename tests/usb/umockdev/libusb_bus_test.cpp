// SPDX-License-Identifier: Apache-2.0
// The transport against unmodified libusb: coming and going, requests, refusals. Streams are in libusb_stream_test.cpp.
#include "device/usb/libusb_bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/fsuid.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "usb/umockdev/usb_fixture.h"

namespace dts::emulator {
namespace {

using core::ErrorCode;
using device::usb::UsbStatus;
using ::testing::HasSubstr;

class LibusbBusTest : public UsbFixture {};

TEST_F(LibusbBusTest, ABusWithoutDevicesListsNone) { EXPECT_THAT(units(), ::testing::IsEmpty()); }

TEST_F(LibusbBusTest, ADevicePluggedInBeforeTheBusIsMadeIsListed) {
  host_.plug(device_);

  const auto found = units();

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].vendor, CountingDevice::kVendor);
  EXPECT_EQ(found[0].product, CountingDevice::kProduct);
  EXPECT_EQ(found[0].release_bcd, 0x1234);
  EXPECT_EQ(found[0].serial, "SN0001");
  EXPECT_EQ(found[0].node(), "/dev/bus/usb/001/002");
}

TEST_F(LibusbBusTest, AnArrivalIsCountedAndTheDeviceListed) {
  ASSERT_THAT(units(), ::testing::IsEmpty());
  const std::uint64_t before = bus_.arrivals();

  host_.plug(device_);

  ASSERT_TRUE(eventually([&] { return bus_.arrivals() == before + 1; }));
  EXPECT_EQ(units().size(), 1U);
}

TEST_F(LibusbBusTest, OtherProductsAreNotListed) {
  host_.plug(device_);
  const std::array<device::usb::UsbModel, 1> others{{{0x09db, 0x00ea, "other", "mcc:other"}}};

  const auto found = bus_.units(others);

  ASSERT_TRUE(found);
  EXPECT_TRUE(found->empty());
}

TEST_F(LibusbBusTest, TwoDevicesOfOneKindAreToldApartBySerial) {
  CountingDevice second("SN0002");
  host_.plug(device_);
  host_.plug(second);

  const auto found = units();

  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].serial, "SN0001");
  EXPECT_EQ(found[1].serial, "SN0002");
  host_.unplug(second);
}

TEST_F(LibusbBusTest, ListingDoesNotOpenADeviceWhoseSerialIsInSysfs) {
  host_.plug(device_);
  host_.occupy(device_, true);
  device_.is_mute = true;  // would cost a time-out

  EXPECT_EQ(units().at(0).serial, "SN0001");
}

TEST_F(LibusbBusTest, EndpointsAndSpeedComeFromTheDescriptors) {
  CountingDevice fast("SN0002", true);
  host_.plug(device_);
  host_.plug(fast);

  const auto slow_port = open_port(0);
  const auto fast_port = open_port(1);

  EXPECT_FALSE(slow_port->is_high_speed());
  EXPECT_TRUE(fast_port->is_high_speed());
  EXPECT_EQ(slow_port->max_packet_bytes(0x81).value(), CountingDevice::kPacketBytes);
  EXPECT_EQ(slow_port->max_packet_bytes(0x86).error().code, ErrorCode::NotFound);
}

TEST_F(LibusbBusTest, ControlRequestsCarryBytesBothWays) {
  host_.plug(device_);
  const auto port = open_port();
  const std::array<std::uint8_t, 5> sent{1, 2, 3, 4, 5};
  std::array<std::uint8_t, 8> received{};

  EXPECT_EQ(port->control_out({CountingDevice::kEcho}, sent, kTimeoutMs).value(), sent.size());
  const auto count = port->control_in({CountingDevice::kEcho}, received, kTimeoutMs);

  EXPECT_EQ(count.value(), sent.size());
  EXPECT_EQ(received, (std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 0, 0, 0}));
}

TEST_F(LibusbBusTest, ARefusedRequestIsAStall) {
  host_.plug(device_);
  const auto port = open_port();
  std::array<std::uint8_t, 4> received{};

  EXPECT_EQ(port->control_in({0x77}, received, kTimeoutMs).error(), UsbStatus::Stall);
}

TEST_F(LibusbBusTest, AnUnansweredRequestTimesOutAndTheNextOneWorks) {
  host_.plug(device_);
  const auto port = open_port();
  std::array<std::uint8_t, 4> received{};

  EXPECT_EQ(port->control_in({CountingDevice::kSilent}, received, 50).error(), UsbStatus::TimedOut);
  EXPECT_TRUE(port->control_in({CountingDevice::kEcho}, received, kTimeoutMs));
}

TEST_F(LibusbBusTest, ARequestWithoutAFreeDescriptorFailsAndTheNextOneWorks) {
  host_.plug(device_);
  const auto port = open_port();
  std::array<std::uint8_t, 64> received{};
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 0;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);

  const auto request = port->control_in({CountingDevice::kEcho}, received, kTimeoutMs);
  const auto read = port->bulk_in(0x81, received, 20);

  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(request.error(), UsbStatus::NoMemory);
  EXPECT_EQ(read.error(), UsbStatus::NoMemory);
  EXPECT_TRUE(port->control_in({CountingDevice::kEcho}, received, kTimeoutMs));
}

TEST_F(LibusbBusTest, ABulkReadWithoutDataTimesOut) {
  host_.plug(device_);
  const auto port = open_port();
  std::array<std::uint8_t, 64> received{};

  EXPECT_EQ(port->bulk_in(0x81, received, 20).error(), UsbStatus::TimedOut);
}

TEST_F(LibusbBusTest, BulkOutArrives) {
  host_.plug(device_);
  const auto port = open_port();
  const std::vector<std::uint8_t> image(1000, 0xAA);

  EXPECT_EQ(port->bulk_out(0x02, image, kTimeoutMs).value(), image.size());

  host_.locked(device_, [&] { EXPECT_EQ(device_.bytes_swallowed, image.size()); });
}

TEST_F(LibusbBusTest, EveryCallOnAnUnpluggedDeviceSaysSo) {
  host_.plug(device_);
  const auto port = open_port();
  std::array<std::uint8_t, 64> bytes{};

  host_.unplug(device_);

  EXPECT_EQ(port->control_in({CountingDevice::kEcho}, bytes, kTimeoutMs).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port->control_out({CountingDevice::kStop}, {}, kTimeoutMs).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port->bulk_in(0x81, bytes, kTimeoutMs).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port->clear_halt(0x81).error(), UsbStatus::NoDevice);
}

TEST_F(LibusbBusTest, OpeningADeviceThatHasGoneSaysDeviceGone) {
  host_.plug(device_);
  const auto found = units();
  host_.unplug(device_);

  const auto opened = bus_.open(found.at(0));

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::DeviceGone);
}

TEST_F(LibusbBusTest, ADeviceOfAnotherProgramIsRefusedAndFreeLater) {
  host_.plug(device_);
  host_.occupy(device_, true);

  const auto refused = bus_.open(units().at(0));
  host_.occupy(device_, false);
  const auto granted = bus_.open(units().at(0));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::WrongState);
  EXPECT_THAT(refused.error().what, HasSubstr("another program"));
  EXPECT_THAT(refused.error().what, HasSubstr("SN0001"));
  EXPECT_TRUE(granted);
}

TEST_F(LibusbBusTest, ADeviceIsOpenedOnceAndAgainAfterClosing) {
  host_.plug(device_);
  auto first = open_port();

  const auto second = bus_.open(units().at(0));
  first.reset();
  const auto third = bus_.open(units().at(0));

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::WrongState);
  EXPECT_TRUE(third);
}

TEST_F(LibusbBusTest, AMissingPermissionNamesTheUdevRule) {
  host_.plug(device_);
  const auto found = units();
  host_.forbid(device_);
  // The file system takes this thread for nobody's: root would be let in whatever the mode.
  const int before = ::setfsuid(kNobody);

  const auto opened = bus_.open(found.at(0));

  ::setfsuid(static_cast<uid_t>(before));
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::NotAllowed);
  EXPECT_THAT(opened.error().what, HasSubstr("EACCES"));
  EXPECT_THAT(opened.error().hint, HasSubstr("70-dtsd.rules"));
  EXPECT_THAT(opened.error().hint, HasSubstr("udevadm control --reload && udevadm trigger"));
}

TEST_F(LibusbBusTest, APluggedDeviceThatAsksForItLeavesAndComesBack) {
  host_.plug(device_);
  auto port = open_port();
  const std::uint64_t before = bus_.arrivals();

  EXPECT_TRUE(port->control_out({CountingDevice::kLeave}, {}, kTimeoutMs));

  ASSERT_TRUE(eventually([&] { return bus_.arrivals() > before && units().size() == 1; }));
  EXPECT_EQ(units().at(0).address, 3);  // a new address, the same serial
  EXPECT_EQ(units().at(0).serial, "SN0001");
}

TEST_F(LibusbBusTest, TwentyReplugsOpenTwentyTimes) {
  for (int cycle = 0; cycle < 20; ++cycle) {
    host_.plug(device_);
    ASSERT_TRUE(eventually([&] { return units().size() == 1; })) << "cycle " << cycle;
    const auto port = open_port();
    ASSERT_TRUE(port->control_out({CountingDevice::kStop}, {}, kTimeoutMs)) << "cycle " << cycle;
    host_.unplug(device_);
    ASSERT_TRUE(eventually([&] { return units().empty(); })) << "cycle " << cycle;
  }
  EXPECT_EQ(device_.power_ups, 20);
}

TEST_F(LibusbBusTest, ASerialThatSysfsDoesNotHaveIsAskedFor) {
  host_.hides_serial = true;
  host_.plug(device_);

  EXPECT_EQ(units().at(0).serial, "SN0001");
}

TEST_F(LibusbBusTest, ADeviceWithoutSerialHasNone) {
  CountingDevice nameless("");
  host_.plug(nameless);

  EXPECT_EQ(units().at(0).serial, "");
  host_.unplug(nameless);
}

}  // namespace
}  // namespace dts::emulator
