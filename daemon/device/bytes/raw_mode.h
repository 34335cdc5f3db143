// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::device::bytes {

/// Sets a tty to raw bytes: 8 data bits, no parity, 1 stop bit, no flow control, no modem control, HUPCL off, any baud rate.
/// Returns 0, or the errno of the system call that failed. Its own file: the kernel's termios2 and glibc's termios exclude each other.
[[nodiscard]] int set_raw_mode(int tty, std::uint32_t baud) noexcept;

/// Returns the baud rate that the port runs, which may differ from the wanted one; 0 if it cannot be read.
[[nodiscard]] std::uint32_t baud_of(int tty) noexcept;

/// Asks the driver to pass bytes on at once (FTDI waits 16 ms otherwise). Not all drivers know it: no error.
void request_low_latency(int tty) noexcept;

/// Discards what has arrived and what was not sent yet.
void discard_waiting_bytes(int tty) noexcept;

}  // namespace dts::device::bytes
