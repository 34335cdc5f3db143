// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace dts::emulator {

/// What an emulated device does wrong, and when: codes (single samples) are counted since the scan's start. A fault strikes once,
/// then it is spent, unless a line says otherwise. Set before the scan, or while the host is locked.
struct Faults {
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t drop_code_at = kNever;         ///< This code is missing from the stream: all later channels are rotated by one.
  std::uint64_t drop_packet_at_code = kNever;  ///< The packet with this code is missing.
  std::size_t drop_packets = 1;                ///< So many are; MCC only.
  std::uint64_t pause_at_code = kNever;        ///< From here on nothing is sent for `pause_ns`, while the FIFO fills; nothing is lost.
  std::int64_t pause_ns = 0;
  std::uint64_t silence_at_code = kNever;       ///< From here on nothing is sent, though the device says that it runs.
  std::uint64_t stall_at_code = kNever;         ///< The data endpoint halts here.
  std::uint64_t overrun_at_code = kNever;       ///< The FIFO overruns here as if the host had not read.
  std::uint64_t short_packet_at_code = kNever;  ///< The packet is cut to an odd number of bytes there.
  std::uint64_t babble_at_code = kNever;        ///< A packet longer than the endpoint's size.
  std::uint64_t corrupt_at_code = kNever;       ///< U6: a wrong checksum; others: this code has its bits turned.
  std::uint64_t skip_counter_at_code = kNever;  ///< U6: the packet counter jumps by one.
  std::size_t calibration_bytes = std::numeric_limits<std::size_t>::max();  ///< Calibration reads end after so many. Stays.
  bool is_calibration_garbage = false;                                      ///< Slopes that are not numbers. Stays.
  int silent_control_requests = 0;                                          ///< So many requests are never answered.
  bool is_mute = false;                                                     ///< Present, enumerates, answers no request at all. Stays.
  bool keeps_endpoint_buffer = false;  ///< Two packets of a stopped scan survive clearing the FIFO. Stays.
  double clock_error_ppm = 0.0;        ///< Positive: the device's clock runs fast. Stays.
  double rate_factor = 1.0;            ///< The scan really runs at this multiple of what was asked. Stays.
};

}  // namespace dts::emulator
