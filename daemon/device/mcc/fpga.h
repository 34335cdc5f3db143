// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "device/usb/daq_driver.h"
#include "device/usb/usb_port.h"

namespace dts::device::mcc {

/// Returns the length of the FPGA image of a USB-1608G product: 73,829 bytes for hardware revision 1 (0x0110 to 0x0112), 73,722
/// for revision 2 (0x0134 to 0x0136).
[[nodiscard]] std::size_t fpga_image_bytes(std::uint16_t product) noexcept;

/// Checks without a device that the file is readable and has one of the two lengths.
[[nodiscard]] core::Status check_fpga_file(const std::string& path);
/// Reads the image from a file of exactly the product's length. The image belongs to MCC and is not part of this project; errors
/// explain where to find it.
[[nodiscard]] core::Result<std::vector<std::uint8_t>> read_fpga_image(const std::string& path, std::uint16_t product);

/// Status word of the USB-1608G (request 0x40).
struct GStatus {
  bool is_running = false;
  bool is_overrun = false;
  bool is_fpga_loaded = false;
  bool is_fpga_loading = false;
};
[[nodiscard]] core::Result<GStatus> read_g_status(usb::UsbPort& port, int timeout_ms = usb::kSetupTimeoutMs);

/// Sends the image in pieces of 64 bytes: more than a thousand requests, about one second.
[[nodiscard]] core::Status load_fpga(usb::UsbPort& port, std::span<const std::uint8_t> image);

}  // namespace dts::device::mcc
