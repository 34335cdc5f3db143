// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/usb_tty.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "core/utf8.h"

namespace dts::device::bytes {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestAttribute = 128;
constexpr int kMostParents = 6;  // tty -> interface -> device: 2 or 3 steps

struct KnownBoard {
  std::uint16_t vendor;
  std::uint16_t product;
  std::string_view name;
};

// USB IDs of the makers. An adapter's ID says nothing about the board behind it: its name says so.
constexpr std::array kKnownBoards{
    KnownBoard{0x2341, 0x0001, "Arduino Uno"},
    KnownBoard{0x2341, 0x0043, "Arduino Uno R3"},
    KnownBoard{0x2a03, 0x0043, "Arduino Uno R3"},
    KnownBoard{0x2341, 0x0010, "Arduino Mega 2560"},
    KnownBoard{0x2341, 0x0042, "Arduino Mega 2560 R3"},
    KnownBoard{0x2341, 0x8036, "Arduino Leonardo"},
    KnownBoard{0x1a86, 0x7523, "board with CH340 adapter (many Nano and Uno copies)"},
    KnownBoard{0x1a86, 0x55d4, "board with CH9102 adapter"},
    KnownBoard{0x0403, 0x6001, "board with FT232 adapter (older Nano)"},
    KnownBoard{0x10c4, 0xea60, "board with CP210x adapter (many ESP32 boards)"},
    KnownBoard{0x2e8a, 0x0005, "RP2040 with MicroPython"},
    KnownBoard{0x2e8a, 0x000a, "RP2040 with the Pico SDK"},
    KnownBoard{0x16c0, 0x0483, "Teensy"},
};

std::string attribute(const fs::path& device, const char* name) {
  std::ifstream file(device / name);
  std::array<char, kLongestAttribute> text{};
  file.read(text.data(), text.size());
  std::string_view line(text.data(), static_cast<std::size_t>(file.gcount()));
  line = line.substr(0, line.find('\n'));
  return core::printable(line);
}

bool read_id(const fs::path& device, const char* name, std::uint16_t& id) {
  const std::string text = attribute(device, name);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id, 16);
  return error == std::errc{} && end == text.data() + text.size();
}

/// Finds the USB device above the port: the first folder that has both IDs.
bool read_usb_device(const fs::path& port, UsbTty& tty) {
  std::error_code error;
  fs::path folder = fs::canonical(port / "device", error);
  for (int i = 0; !error && i < kMostParents && folder.has_relative_path(); ++i, folder = folder.parent_path()) {
    if (!read_id(folder, "idVendor", tty.vendor) || !read_id(folder, "idProduct", tty.product)) continue;
    tty.manufacturer = attribute(folder, "manufacturer");
    tty.product_name = attribute(folder, "product");
    tty.serial = attribute(folder, "serial");
    return true;
  }
  return false;
}

std::string link_to(const std::string& root, const std::string& name) {
  std::error_code error;
  std::vector<std::string> links;
  for (fs::directory_iterator entry(root + "/dev/serial/by-id", error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unreadable;
    if (fs::read_symlink(entry->path(), unreadable).filename() == name) links.push_back(entry->path().filename());
  }
  return links.empty() ? std::string{} : "/dev/serial/by-id/" + *std::ranges::min_element(links);
}

}  // namespace

std::vector<UsbTty> usb_ttys(const std::string& root) {
  std::vector<UsbTty> ttys;
  std::error_code error;
  for (fs::directory_iterator entry(root + "/sys/class/tty", error), end; !error && entry != end; entry.increment(error)) {
    UsbTty tty;
    tty.name = entry->path().filename();
    if (!read_usb_device(entry->path(), tty)) continue;
    tty.by_id = link_to(root, tty.name);
    ttys.push_back(std::move(tty));
  }
  std::ranges::sort(ttys, {}, [](const UsbTty& tty) {  // ttyACM2 before ttyACM10
    return std::tuple(tty.name.substr(0, tty.name.find_first_of("0123456789")), tty.name.size(), tty.name);
  });
  return ttys;
}

std::string_view known_board(std::uint16_t vendor, std::uint16_t product) noexcept {
  const auto* const known =
      std::ranges::find_if(kKnownBoards, [&](const KnownBoard& board) { return board.vendor == vendor && board.product == product; });
  return known == kKnownBoards.end() ? std::string_view{} : known->name;
}

}  // namespace dts::device::bytes
