// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/clock.h"
#include "core/descriptor.h"
#include "device/bytes/byte_link.h"

namespace dts::device::bytes {

inline constexpr std::int64_t kPatienceNs = 30 * core::kNanosecondsPerSecond;

/// The board's side of a pseudo-terminal; the other side is a serial port for dtsd.
class Pty {
 public:
  Pty() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    std::array<char, 64> name{};
    if (::grantpt(master_->get()) != 0 || ::unlockpt(master_->get()) != 0 || ::ptsname_r(master_->get(), name.data(), name.size()) != 0)
      throw std::runtime_error("no pseudo-terminal");
    path_ = name.data();
  }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  void say(std::string_view text) const {
    if (::write(master_->get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) throw std::runtime_error("pty is full");
  }
  /// Returns what dtsd wrote: waits for `count` bytes.
  [[nodiscard]] std::string heard(std::size_t count) const {
    std::string text;
    while (text.size() < count) {
      pollfd waiter{.fd = master_->get(), .events = POLLIN, .revents = 0};
      if (::poll(&waiter, 1, 30'000) <= 0) return text + " (then nothing)";
      std::array<char, 512> part{};
      const ssize_t read = ::read(master_->get(), part.data(), part.size());
      if (read <= 0) return text + " (then the end)";
      text.append(part.data(), static_cast<std::size_t>(read));
    }
    return text;
  }
  /// Returns how many bytes of dtsd can be read before the end; dtsd has closed its side.
  [[nodiscard]] std::size_t waiting() const {
    std::array<char, 4096> part{};
    std::size_t count = 0;
    for (ssize_t read = 0; (read = ::read(master_->get(), part.data(), part.size())) > 0;) count += static_cast<std::size_t>(read);
    return count;
  }
  void unplug() { master_.reset(); }

 private:
  std::optional<core::Descriptor> master_;
  std::string path_;
};

inline std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Reads until `count` bytes have come, or another end than Bytes, which it returns in `end`.
inline std::string read_text(ByteLink& link, std::size_t count, ReadEnd& end) {
  const core::SystemClock clock;
  std::string text;
  std::array<std::uint8_t, 4096> buffer{};
  end = ReadEnd::Bytes;
  while (text.size() < count && end == ReadEnd::Bytes) {
    const BytesRead read = link.read(buffer, clock.now_ns() + kPatienceNs);
    end = read.end;
    text.append(reinterpret_cast<const char*>(buffer.data()), read.count);
  }
  return text;
}

inline std::string read_text(ByteLink& link, std::size_t count) {
  ReadEnd end{};
  return read_text(link, count, end);
}

/// Reads and drops bytes until the link ends otherwise.
inline ReadEnd read_to_end(ByteLink& link) {
  ReadEnd end{};
  static_cast<void>(read_text(link, SIZE_MAX, end));
  return end;
}

}  // namespace dts::device::bytes
