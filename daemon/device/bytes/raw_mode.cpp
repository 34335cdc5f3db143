// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/raw_mode.h"

#include <asm/termbits.h>
#include <linux/serial.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace dts::device::bytes {

int set_raw_mode(int tty, std::uint32_t baud) noexcept {
  struct termios2 mode {};
  if (::ioctl(tty, TCGETS2, &mode) != 0) return errno;
  mode.c_iflag = 0;
  mode.c_oflag = 0;
  mode.c_lflag = 0;
  mode.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
  mode.c_ispeed = baud;
  mode.c_ospeed = baud;
  mode.c_cc[VMIN] = 1;  // with 0, a read of a port without bytes would look like the end of the link
  mode.c_cc[VTIME] = 0;
  if (::ioctl(tty, TCSETS2, &mode) != 0) return errno;
  // The call succeeds if the driver could do any part of it.
  if (::ioctl(tty, TCGETS2, &mode) != 0) return errno;
  const bool is_raw = (mode.c_cflag & (CSIZE | PARENB | CSTOPB)) == CS8 && mode.c_lflag == 0 && mode.c_iflag == 0;
  return is_raw ? 0 : EINVAL;
}

std::uint32_t baud_of(int tty) noexcept {
  struct termios2 mode {};
  return ::ioctl(tty, TCGETS2, &mode) == 0 ? mode.c_ospeed : 0;
}

void request_low_latency(int tty) noexcept {
  struct serial_struct port {};
  if (::ioctl(tty, TIOCGSERIAL, &port) != 0) return;
  port.flags |= ASYNC_LOW_LATENCY;
  static_cast<void>(::ioctl(tty, TIOCSSERIAL, &port));
}

void discard_waiting_bytes(int tty) noexcept { static_cast<void>(::ioctl(tty, TCFLSH, TCIOFLUSH)); }

}  // namespace dts::device::bytes
