// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dts::device::usb {

/// Codes between transfers and blocks: whole scans and at most one incomplete scan. A scan may begin and end anywhere in a packet or
/// transfer; this buffer keeps the position in the scan. Thread: the reader.
/// Realtime-safe: yes, after construction.
class ScanBuffer {
 public:
  ScanBuffer() = default;
  ScanBuffer(std::size_t channels, std::size_t capacity_scans) : channels_(channels), codes_(channels * (capacity_scans + 1)) {}

  /// Returns the free space after the newest code: at least half of the buffer, unless more than half is in use.
  [[nodiscard]] std::span<std::uint16_t> room() noexcept;
  /// Adds the `count` codes that the caller wrote to the beginning of `room()`.
  void add(std::size_t count) noexcept;
  /// Discards the incomplete scan: the next code is channel 0.
  void drop_incomplete() noexcept;
  void clear() noexcept;

  [[nodiscard]] std::size_t scans() const noexcept { return (end_ - begin_) / channels_; }
  /// Returns a waiting scan, 0 is the oldest; `index` < `scans()`.
  [[nodiscard]] std::span<const std::uint16_t> scan(std::size_t index) const noexcept {
    return {codes_.data() + begin_ + index * channels_, channels_};
  }
  /// Removes the `count` oldest scans.
  void remove(std::size_t count) noexcept { begin_ += count * channels_; }

 private:
  std::size_t channels_ = 1;
  std::size_t begin_ = 0;  ///< First code of the oldest scan.
  std::size_t end_ = 0;    ///< One past the newest code.
  std::vector<std::uint16_t> codes_;
};

}  // namespace dts::device::usb
