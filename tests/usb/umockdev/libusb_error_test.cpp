// SPDX-License-Identifier: Apache-2.0
#include "device/usb/libusb_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libusb-1.0/libusb.h>

#include <cerrno>

namespace dts::device::usb {
namespace {

using core::ErrorCode;
using ::testing::HasSubstr;

const UsbUnit kUnit{.vendor = 0x09db, .product = 0x00ea, .release_bcd = 0x0102, .bus = 1, .address = 7, .serial = "01AB"};

TEST(LibusbErrorTest, EveryMessageNamesTheDeviceItsNodeAndItsSerial) {
  const core::Error error = open_error(LIBUSB_ERROR_OTHER, 0, kUnit);

  EXPECT_THAT(error.what, HasSubstr("09db:00ea"));
  EXPECT_THAT(error.what, HasSubstr("/dev/bus/usb/001/007"));
  EXPECT_THAT(error.what, HasSubstr("01AB"));
}

TEST(LibusbErrorTest, AMissingRuleAndAServicePolicyAreToldApart) {
  const core::Error rule = open_error(LIBUSB_ERROR_ACCESS, EACCES, kUnit);
  const core::Error policy = open_error(LIBUSB_ERROR_ACCESS, EPERM, kUnit);

  EXPECT_EQ(rule.code, ErrorCode::NotAllowed);
  EXPECT_EQ(policy.code, ErrorCode::NotAllowed);
  EXPECT_THAT(rule.hint, HasSubstr("70-dtsd.rules"));
  EXPECT_THAT(policy.hint, HasSubstr("DeviceAllow=char-usb_device"));
}

TEST(LibusbErrorTest, BusyIsAnotherProgramAndNoDeviceIsGone) {
  EXPECT_EQ(open_error(LIBUSB_ERROR_BUSY, 0, kUnit).code, ErrorCode::WrongState);
  EXPECT_EQ(open_error(LIBUSB_ERROR_NO_DEVICE, 0, kUnit).code, ErrorCode::DeviceGone);
  EXPECT_EQ(open_error(LIBUSB_ERROR_IO, ENOENT, kUnit).code, ErrorCode::DeviceGone);
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
  EXPECT_EQ(status_of_error(LIBUSB_ERROR_BUSY), UsbStatus::Failed);
}

}  // namespace
}  // namespace dts::device::usb
