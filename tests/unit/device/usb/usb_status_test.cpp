// SPDX-License-Identifier: Apache-2.0
#include "device/usb/usb_status.h"

#include <gtest/gtest.h>

#include <set>

#include "device/usb/usb_port.h"

namespace dts::device::usb {
namespace {

TEST(UsbStatus, EveryStatus_HasItsWords) {
  std::set<std::string> texts;
  for (int i = 0; i <= static_cast<int>(UsbStatus::Failed); ++i) texts.insert(to_string(static_cast<UsbStatus>(i)));
  EXPECT_EQ(texts.size(), 8U);
  EXPECT_NE(to_string(static_cast<UsbStatus>(99)).find("99"), std::string::npos);
}

TEST(UsbStatus, Error_CodeAndSentence) {
  EXPECT_EQ(to_error(UsbStatus::NoDevice, "x").code, core::ErrorCode::DeviceGone);
  EXPECT_EQ(to_error(UsbStatus::TimedOut, "x").code, core::ErrorCode::Timeout);
  for (const UsbStatus status : {UsbStatus::Stall, UsbStatus::Overflow, UsbStatus::Cancelled, UsbStatus::Failed}) {
    EXPECT_EQ(to_error(status, "x").code, core::ErrorCode::Failed);
  }
  const core::Error error = to_error(UsbStatus::NoDevice, "reading the calibration", "plug it in");
  EXPECT_EQ(core::to_string(error), "reading the calibration: device is gone (plug it in)");
}

TEST(UsbStatus, NoMemory_SaysWhichLimitToRaise) {
  EXPECT_NE(to_error(UsbStatus::NoMemory, "x").hint.find("/sys/module/usbcore/parameters/usbfs_memory_mb"), std::string::npos);
}

TEST(UsbUnit, Node_ThreeDigitsEach) {
  const UsbUnit unit{.bus = 1, .address = 42, .serial = {}};
  EXPECT_EQ(unit.node(), "/dev/bus/usb/001/042");
}

}  // namespace
}  // namespace dts::device::usb
