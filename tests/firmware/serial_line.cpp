// SPDX-License-Identifier: Apache-2.0
#include "firmware/serial_line.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <utility>

namespace dts::firmware_test {

core::Result<SerialLine> SerialLine::open() {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> name{};
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0 || ::ptsname_r(master, name.data(), name.size()) != 0) {
    if (master >= 0) ::close(master);
    return core::fail(core::ErrorCode::Failed, "cannot open a pseudo-terminal", "mount /dev/pts");
  }
  SerialLine line(master, name.data());
  // Opened and closed once: from then on the system reports whether a host has it open.
  const int slave = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (slave < 0 || ::tcgetattr(slave, &settings) != 0) {
    if (slave >= 0) ::close(slave);
    return core::fail(core::ErrorCode::Failed, "cannot open " + line.path_, "check the permissions of /dev/pts");
  }
  ::cfmakeraw(&settings);
  ::tcsetattr(slave, TCSANOW, &settings);
  ::close(slave);
  return line;
}

SerialLine::SerialLine(SerialLine&& other) noexcept : master_(std::exchange(other.master_, -1)), path_(std::move(other.path_)) {}

SerialLine::~SerialLine() {
  if (master_ >= 0) ::close(master_);
}

bool SerialLine::has_host() const {
  pollfd wait{master_, 0, 0};
  return ::poll(&wait, 1, 0) == 0 || (wait.revents & POLLHUP) == 0;
}

std::vector<std::uint8_t> SerialLine::read() {
  std::array<std::uint8_t, 256> bytes{};
  const ssize_t count = ::read(master_, bytes.data(), bytes.size());
  return count > 0 ? std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + count) : std::vector<std::uint8_t>{};
}

std::size_t SerialLine::write(std::span<const std::uint8_t> bytes) {
  if (!has_host()) return bytes.size();
  const ssize_t count = ::write(master_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace dts::firmware_test
