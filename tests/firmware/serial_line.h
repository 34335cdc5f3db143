// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::firmware_test {

/// A pseudo-terminal in place of the board's USB port. Thread: one.
class SerialLine {
 public:
  /// Opens one. Its other end has a path, and works as a serial port for other programs.
  [[nodiscard]] static core::Result<SerialLine> open();
  ~SerialLine();
  SerialLine(SerialLine&& other) noexcept;
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Returns whether a program has the other end open.
  [[nodiscard]] bool has_host() const;
  /// Returns the bytes that the host has sent; never waits.
  [[nodiscard]] std::vector<std::uint8_t> read();
  /// Sends what the line takes now. Returns the number of bytes; without a host, all of them are lost, as on a real line.
  [[nodiscard]] std::size_t write(std::span<const std::uint8_t> bytes);

 private:
  SerialLine(int master, std::string path) : master_(master), path_(std::move(path)) {}

  int master_ = -1;
  std::string path_;
};

}  // namespace dts::firmware_test
