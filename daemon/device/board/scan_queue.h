// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dts::device::board {

/// Scans between the input and the blocks. Only the constructor allocates. Thread: one. Realtime-safe: yes.
class ScanQueue {
 public:
  ScanQueue(std::size_t channels, std::size_t capacity)
      : channels_(channels), capacity_(capacity), values_(channels * capacity), quality_(channels * capacity), positions_(capacity) {}

  [[nodiscard]] std::size_t channels() const noexcept { return channels_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool has_room(std::size_t scans) const noexcept { return scans <= capacity_ - size_; }

  struct Slot {
    std::span<double> values;
    std::span<std::uint8_t> quality;
  };
  /// Adds a scan, whose values and quality the caller writes. `position`: see `Timeline`. Needs room.
  [[nodiscard]] Slot add(std::uint64_t position) noexcept {
    const std::size_t at = (begin_ + size_) % capacity_;
    ++size_;
    positions_[at] = position;
    return {{values_.data() + at * channels_, channels_}, {quality_.data() + at * channels_, channels_}};
  }
  /// Removes the newest scan.
  void take_back() noexcept { --size_; }

  /// Values of a waiting scan, 0 is the oldest; `index` < `size()`.
  [[nodiscard]] std::span<const double> values(std::size_t index) const noexcept {
    return {values_.data() + (begin_ + index) % capacity_ * channels_, channels_};
  }
  [[nodiscard]] std::span<const std::uint8_t> quality(std::size_t index) const noexcept {
    return {quality_.data() + (begin_ + index) % capacity_ * channels_, channels_};
  }
  [[nodiscard]] std::uint64_t position(std::size_t index) const noexcept { return positions_[(begin_ + index) % capacity_]; }
  /// Removes the `count` oldest scans.
  void remove(std::size_t count) noexcept {
    begin_ = (begin_ + count) % capacity_;
    size_ -= count;
  }

 private:
  std::size_t channels_;
  std::size_t capacity_;
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
  std::vector<double> values_;
  std::vector<std::uint8_t> quality_;
  std::vector<std::uint64_t> positions_;
};

}  // namespace dts::device::board
