// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dts::device::usb {

/// Codes on their way from transfers to blocks: whole scans and at most one that is still incomplete. The boundaries of
/// scans, packets and transfers have nothing to do with each other; the phase is carried here. Thread: the reader.
/// Realtime-safe: yes, after construction.
class ScanBuffer {
 public:
  ScanBuffer() = default;
  ScanBuffer(std::size_t channels, std::size_t capacity_scans) : channels_(channels), codes_(channels * (capacity_scans + 1)) {}

  /// Room behind the newest code. At least half of the buffer, unless so much of it waits to be taken.
  [[nodiscard]] std::span<std::uint16_t> room() noexcept;
  /// `count` codes were written to the beginning of `room()`.
  void add(std::size_t count) noexcept;
  /// Drops the incomplete scan: the next code is channel 0.
  void drop_incomplete() noexcept;
  void clear() noexcept;

  [[nodiscard]] std::size_t scans() const noexcept { return (end_ - begin_) / channels_; }
  /// Scan `index` of those waiting; `index` < `scans()`.
  [[nodiscard]] std::span<const std::uint16_t> scan(std::size_t index) const noexcept {
    return {codes_.data() + begin_ + index * channels_, channels_};
  }
  /// The `count` oldest scans are done with.
  void take(std::size_t count) noexcept { begin_ += count * channels_; }

 private:
  std::size_t channels_ = 1;
  std::size_t begin_ = 0;  ///< First code of the oldest scan.
  std::size_t end_ = 0;    ///< Behind the newest code.
  std::vector<std::uint16_t> codes_;
};

}  // namespace dts::device::usb
