// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/clock.h"
#include "device/bytes/byte_link.h"

namespace dts::device::bytes {

/// Creates a closed link to a serial port: raw 8N1 at `baud`, for this program alone.
///
/// `path`: "/dev/ttyACM0", a link of /dev/serial/by-id, or a pseudo-terminal. `usb_serial`: USB serial number of the adapter; empty: any.
/// With it, `open` uses the port that has this number, under whatever name it comes back. If no port has it, `open` uses `path` if its
/// adapter has no number or `path` is a link of /dev/serial/by-id: the number may be the board's own, which only its answer shows. So the
/// caller compares `facts().serial` and the board's answer. `sysfs_root`: folder that holds sys/ and dev/, for tests; empty: the machine's
/// own. `clock` must outlive the link.
[[nodiscard]] std::unique_ptr<ByteLink> create_serial_port(std::string path, std::string usb_serial, std::uint32_t baud, core::Clock& clock,
                                                           std::string sysfs_root = {});

}  // namespace dts::device::bytes
