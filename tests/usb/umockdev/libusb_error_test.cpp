// SPDX-License-Identifier: Apache-2.0
#include "device/usb/libusb_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libusb-1.0/libusb.h>

#include <cerrno>
#include <string>
#include <tuple>

namespace dts::device::usb {
namespace {

using core::ErrorCode;
using ::testing::HasSubstr;

const UsbUnit kUnit{.vendor = 0x09db, .product = 0x00ea, .release_bcd = 0x0102, .bus = 1, .address = 7, .serial = "01AB"};

TEST(LibusbErrorTest, EachRefusalNamesTheDeviceTheReasonAndWhatToDo) {
  const std::string what = "cannot open USB device 09db:00ea at /dev/bus/usb/001/007, serial 01AB: ";
  const std::string gone = what + "it is no longer there";
  const std::string busy = what + "another program or rig is using it";
  for (const auto& [error, number, expected, hint] :
       {std::tuple{LIBUSB_ERROR_BUSY, 0, core::Error{ErrorCode::WrongState, busy, ""}, "close the other program"},
        {LIBUSB_ERROR_IO, EBUSY, {ErrorCode::WrongState, busy, ""}, "close the other program"},
        {LIBUSB_ERROR_NO_DEVICE, 0, {ErrorCode::DeviceGone, gone, ""}, "plug it in"},
        {LIBUSB_ERROR_IO, ENOENT, {ErrorCode::DeviceGone, gone, ""}, "plug it in"},
        {LIBUSB_ERROR_IO, ENODEV, {ErrorCode::DeviceGone, gone, ""}, "plug it in"},
        {LIBUSB_ERROR_IO, ENXIO, {ErrorCode::DeviceGone, gone, ""}, "plug it in"},
        {LIBUSB_ERROR_ACCESS,
         EACCES,
         {ErrorCode::NotAllowed, what + "no permission to write to the node (EACCES): the udev rule is missing", ""},
         "70-dtsd.rules"},
        {LIBUSB_ERROR_ACCESS, EPERM, {ErrorCode::NotAllowed, what + "the system forbids it (EPERM)", ""}, "DeviceAllow=char-usb_device"},
        {LIBUSB_ERROR_OTHER, EIO, {ErrorCode::Failed, what + "Input/output error", ""}, "unplug the device"},
        {LIBUSB_ERROR_OTHER, 0, {ErrorCode::Failed, what + "Other error", ""}, "unplug the device"}}) {
    const core::Error found = open_error(error, number, kUnit);
    EXPECT_EQ(found.code, expected.code) << found.what;
    EXPECT_EQ(found.what, expected.what);
    EXPECT_THAT(found.hint, HasSubstr(hint));
  }
}

TEST(LibusbErrorTest, TransferStatusesKeepTheirMeaning) {
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_COMPLETED), UsbStatus::Completed);
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_STALL), UsbStatus::Stall);
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_NO_DEVICE), UsbStatus::NoDevice);
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_OVERFLOW), UsbStatus::Overflow);
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_TIMED_OUT), UsbStatus::TimedOut);
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_CANCELLED), UsbStatus::Cancelled);
  EXPECT_EQ(status_of_transfer(LIBUSB_TRANSFER_ERROR), UsbStatus::Failed);
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_NO_DEVICE), UsbStatus::NoDevice);
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_NO_MEM), UsbStatus::NoMemory);
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_PIPE), UsbStatus::Stall);
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_TIMEOUT), UsbStatus::TimedOut);
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_OVERFLOW), UsbStatus::Overflow);
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_BUSY), UsbStatus::Failed);
}

}  // namespace
}  // namespace dts::device::usb
