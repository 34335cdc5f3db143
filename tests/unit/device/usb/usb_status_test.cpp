// SPDX-License-Identifier: Apache-2.0
#include "device/usb/usb_status.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "device/usb/usb_port.h"

namespace dts::device::usb {
namespace {

TEST(UsbStatus, EachStatus_HasItsWordsAndItsError) {
  using enum core::ErrorCode;
  const std::string memory = "end clients that are not needed, or write a larger number to /sys/module/usbcore/parameters/usbfs_memory_mb";
  for (const auto& [status, code, words, hint] :
       {std::tuple{UsbStatus::Completed, Failed, "completed", ""},
        {UsbStatus::Stall, Failed, "device rejected it (stall)", ""},
        {UsbStatus::NoDevice, DeviceGone, "device is gone", ""},
        {UsbStatus::Overflow, Failed, "device sent more data than the buffer holds", ""},
        {UsbStatus::TimedOut, Timeout, "device did not answer in time", ""},
        {UsbStatus::Cancelled, Failed, "cancelled", ""},
        {UsbStatus::NoMemory, Failed, "no memory or no file descriptor is left for USB transfers", memory.c_str()},
        {UsbStatus::Failed, Failed, "transfer failed on the bus (cable, hub or host controller)", ""},
        {static_cast<UsbStatus>(99), Failed, "unknown status 99", ""}}) {
    EXPECT_EQ(to_string(status), words);
    EXPECT_EQ(to_error(status, "reading"), (core::Error{code, std::string("reading: ") + words, hint}));
    EXPECT_EQ(to_error(status, "reading", "plug it in").hint, "plug it in");
  }
}

TEST(UsbUnit, Node_ThreeDigitsEach) {
  const UsbUnit unit{.bus = 1, .address = 42, .serial = {}};
  EXPECT_EQ(unit.node(), "/dev/bus/usb/001/042");
}

}  // namespace
}  // namespace dts::device::usb
