// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/frame.h"
#include "device/labjack/u6_timing.h"
#include "device/usb/daq_driver.h"

namespace dts::device::labjack {

/// Converts StreamData packets to codes (U6 data sheet, StreamData; U3 data sheet 5.2.12 for auto-recovery).
///
///     0 checksum8 | 1..3 F9 4+n C0 | 4 5 checksum16 | 6 7 scans discarded | 8 9 | 10 counter | 11 error | 12.. n samples | backlog | 0
///
/// A scan may cross packets. Every packet is checked: checksums, header, counter, error number. After an overrun of its FIFO the device
/// sends the samples of the FIFO, which are good, in packets with error 59. Then it sends one packet with error 60: it contains the number
/// of discarded scans and, at the place of the discarded scans, one dummy scan of 0xFFFF, which counts as one of them:
///
///     59 [good good good]  60 [good FFFF..FFFF new new]  0 [new new new]
///                                  ^ gap of `discarded` scans, the stream continues
class StreamParser {
 public:
  /// Starts a new stream; `channels` and `samples_per_packet` must be in 1..25.
  void restart(std::size_t channels, std::size_t samples_per_packet) noexcept;
  /// Works as DaqDriver::unpack. Realtime-safe: yes.
  [[nodiscard]] usb::Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept;
  /// Returns true while the device empties its FIFO after an overrun. Thread: any.
  [[nodiscard]] bool is_recovering() const noexcept { return is_recovering_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kHeaderBytes = 12;
  static constexpr std::size_t kLargestPacketBytes = kHeaderBytes + 2 * kMaximumSamplesPerPacket + 2;

  [[nodiscard]] core::GapReason examine(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] core::GapReason examine_error(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] bool find_dummy(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] bool pass_over_dummy(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] static std::uint16_t sample(std::span<const std::uint8_t> packet, std::size_t index) noexcept;
  /// Writes as many samples as fit; returns true if the packet is finished.
  [[nodiscard]] bool deliver(std::span<const std::uint8_t> packet, std::span<std::uint16_t> codes, usb::Unpacked& result) noexcept;

  std::size_t channels_ = 1;
  std::size_t samples_ = kMaximumSamplesPerPacket;
  std::size_t packet_bytes_ = kLargestPacketBytes;
  std::array<std::uint8_t, kLargestPacketBytes> held_{};  ///< The current packet; it may be split between two transfers.
  std::size_t held_bytes_ = 0;
  bool is_examined_ = false;  ///< The current packet has been checked.
  std::size_t taken_ = 0;     ///< Number of its samples that are processed.
  std::size_t phase_ = 0;     ///< Channel of the next sample.
  std::optional<std::uint8_t> next_counter_;
  std::optional<std::size_t> dummy_at_;  ///< First sample of the dummy scan in the current packet.
  std::uint64_t discarded_ = 0;
  std::size_t dummy_left_ = 0;  ///< Number of samples of the dummy scan in the next packet.
  std::atomic<bool> is_recovering_{false};
};

}  // namespace dts::device::labjack
