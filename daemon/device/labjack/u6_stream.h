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

/// StreamData packets to codes (U6 data sheet, StreamData; U3 data sheet 5.2.12 for auto-recovery).
///
///     0 checksum8 | 1..3 F9 4+n C0 | 4 5 checksum16 | 6 7 scans discarded | 8 9 | 10 counter | 11 error | 12.. n samples | backlog | 0
///
/// Scans run across packets. Every packet is checked: checksums, header, counter, error number. A full FIFO is told by error 59
/// while its samples are sent (they are good), then by one packet with error 60, the number of scans discarded and, where they
/// are missing, one dummy scan of 0xFFFF, which stands for one of them:
///
///     59 [good good good]  60 [good FFFF..FFFF new new]  0 [new new new]
///                                  ^ gap of `discarded` scans, the stream goes on
class StreamParser {
 public:
  /// `channels` and `samples_per_packet` in 1..25.
  void restart(std::size_t channels, std::size_t samples_per_packet) noexcept;
  /// As DaqDriver::unpack. Realtime-safe: yes.
  [[nodiscard]] usb::Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept;
  /// The device's FIFO was full and is being emptied. Thread: any.
  [[nodiscard]] bool is_recovering() const noexcept { return is_recovering_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kHeaderBytes = 12;
  static constexpr std::size_t kLargestPacketBytes = kHeaderBytes + 2 * kMaximumSamplesPerPacket + 2;

  [[nodiscard]] core::GapReason examine(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] core::GapReason examine_error(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] bool find_dummy(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] bool pass_over_dummy(std::span<const std::uint8_t> packet) noexcept;
  [[nodiscard]] static std::uint16_t sample(std::span<const std::uint8_t> packet, std::size_t index) noexcept;
  /// Writes what it can; true: the packet is done with.
  [[nodiscard]] bool deliver(std::span<const std::uint8_t> packet, std::span<std::uint16_t> codes, usb::Unpacked& result) noexcept;

  std::size_t channels_ = 1;
  std::size_t samples_ = kMaximumSamplesPerPacket;
  std::size_t packet_bytes_ = kLargestPacketBytes;
  std::array<std::uint8_t, kLargestPacketBytes> held_{};  ///< A packet that lies across two transfers.
  std::size_t held_bytes_ = 0;
  bool is_examined_ = false;  ///< The packet at hand is sound; `taken_` of its samples are done with.
  std::size_t taken_ = 0;
  std::size_t phase_ = 0;  ///< Channel of the next sample.
  std::optional<std::uint8_t> next_counter_;
  std::optional<std::size_t> dummy_at_;  ///< First sample of the dummy scan in the packet at hand.
  std::uint64_t discarded_ = 0;
  std::size_t dummy_left_ = 0;  ///< Samples of the dummy scan that come in the next packet.
  std::atomic<bool> is_recovering_{false};
};

}  // namespace dts::device::labjack
