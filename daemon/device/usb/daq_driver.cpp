// SPDX-License-Identifier: Apache-2.0
#include "device/usb/daq_driver.h"

namespace dts::device::usb {

core::Status DaqDriver::set_sync_output(UsbPort&, bool) {
  return core::fail(core::ErrorCode::Unsupported, describe().uri + " has no digital output for a sync pulse");
}

}  // namespace dts::device::usb
