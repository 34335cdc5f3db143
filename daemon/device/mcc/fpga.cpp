// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/fpga.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "device/mcc/control.h"

namespace dts::device::mcc {
namespace {

using core::ErrorCode;

constexpr std::uint8_t kFpgaStatus = 0x40;
constexpr std::uint8_t kFpgaCommand = 0x50;
constexpr std::uint8_t kFpgaData = 0x51;
constexpr std::array<std::uint8_t, 1> kEnterLoading = {0xAD};
constexpr std::size_t kPieceBytes = 64;
constexpr int kMostStatusRequests = 250;  // PyDAQFlex waits 0.25 s before it reads the status; a request takes one or two frames

constexpr std::uint16_t kFirstRevision2 = 0x0134;
constexpr std::size_t kRevision1Bytes = 73'829;
constexpr std::size_t kRevision2Bytes = 73'722;

constexpr char kSourceHint[] =
    "take the image from MCC's library uldaq (1.2.1: the array in src/usb/fw/Usb1608gFpga.c, or Usb1608g2Fpga.c for hardware revision 2): "
    "write the array's bytes to a file and add fpga=FILE to the device address";

core::Result<std::uintmax_t> length_of(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) return core::fail(ErrorCode::NotFound, "FPGA image " + path + ": " + error.message(), kSourceHint);
  return bytes;
}

core::Error unreadable(const std::string& path) {
  return {ErrorCode::Failed, "FPGA image " + path + " cannot be read", "check its permissions"};
}

}  // namespace

std::size_t fpga_image_bytes(std::uint16_t product) noexcept { return product < kFirstRevision2 ? kRevision1Bytes : kRevision2Bytes; }

core::Status check_fpga_file(const std::string& path) {
  DTS_TRY_ASSIGN(const auto bytes, length_of(path));
  if (bytes != kRevision1Bytes && bytes != kRevision2Bytes) {
    return core::fail(ErrorCode::InvalidArgument,
                      "FPGA image " + path + " has " + std::to_string(bytes) + " bytes; MCC's have " + std::to_string(kRevision1Bytes) +
                          " or, for hardware revision 2, " + std::to_string(kRevision2Bytes),
                      kSourceHint);
  }
  if (std::ifstream(path, std::ios::binary).get() == std::ifstream::traits_type::eof()) return tl::make_unexpected(unreadable(path));
  return {};
}

core::Result<std::vector<std::uint8_t>> read_fpga_image(const std::string& path, std::uint16_t product) {
  if (path.empty())
    return core::fail(ErrorCode::NotFound, "the device has no FPGA image since its power-up, and none was given", kSourceHint);
  DTS_TRY_ASSIGN(const auto size, length_of(path));
  const std::size_t expected = fpga_image_bytes(product);
  if (size != expected) {
    return core::fail(
        ErrorCode::InvalidArgument,
        "FPGA image " + path + " has " + std::to_string(size) + " bytes; this unit's hardware revision needs " + std::to_string(expected),
        kSourceHint);
  }
  std::vector<std::uint8_t> image(expected);
  std::ifstream file(path, std::ios::binary);
  for (std::uint8_t& byte : image) byte = static_cast<std::uint8_t>(file.get());
  if (!file) return tl::make_unexpected(unreadable(path));
  return image;
}

core::Result<GStatus> read_g_status(usb::UsbPort& port, int timeout_ms) {
  return get_word(port, {.request = kFpgaStatus}, "reading the status", timeout_ms).map([](std::uint16_t status) {
    return GStatus{.is_running = (status & 1U << 1) != 0,
                   .is_overrun = (status & 1U << 2) != 0,
                   .is_fpga_loaded = (status & 1U << 8) != 0,
                   .is_fpga_loading = (status & 1U << 9) != 0};
  });
}

core::Status load_fpga(usb::UsbPort& port, std::span<const std::uint8_t> image) {
  DTS_TRY(put(port, {.request = kFpgaCommand}, kEnterLoading, "entering the FPGA's configuration mode"));
  DTS_TRY_ASSIGN(const auto entered, read_g_status(port));
  if (!entered.is_fpga_loading) return core::fail(ErrorCode::Failed, "the device does not enter its FPGA's configuration mode");
  for (std::size_t at = 0; at < image.size(); at += kPieceBytes) {
    const auto piece = image.subspan(at, std::min(kPieceBytes, image.size() - at));
    DTS_TRY(put(port, {.request = kFpgaData}, piece, "loading the FPGA image"));
  }
  for (int i = 0; i < kMostStatusRequests; ++i) {
    DTS_TRY_ASSIGN(const auto status, read_g_status(port));
    if (status.is_fpga_loaded) return {};
  }
  return core::fail(ErrorCode::Failed, "the device did not accept the FPGA image", kSourceHint);
}

}  // namespace dts::device::mcc
