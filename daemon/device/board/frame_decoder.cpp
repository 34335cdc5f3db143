// SPDX-License-Identifier: Apache-2.0
#include "device/board/frame_decoder.h"

#include <utility>

#include "device/board/frames.h"

namespace dts::device::board {

void FrameDecoder::restart() noexcept {
  length_ = 0;
  is_too_long_ = false;
  is_in_step_ = false;
}

FrameDecoder::Taken FrameDecoder::take(std::span<const std::uint8_t> bytes) noexcept {
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    if (bytes[at] != 0) {
      if (length_ < stuffed_.size()) {
        stuffed_[length_++] = bytes[at];
      } else {
        is_too_long_ = true;
      }
      continue;
    }
    if (const std::span<const std::uint8_t> payload = finish(); !payload.empty()) return {at + 1, payload};
  }
  return {bytes.size(), {}};
}

/// Ends a frame at its 0x00. Returns its payload; empty if it is not good.
std::span<const std::uint8_t> FrameDecoder::finish() noexcept {
  const std::size_t length = std::exchange(length_, 0);
  const bool is_too_long = std::exchange(is_too_long_, false);
  const bool was_in_step = std::exchange(is_in_step_, true);
  if (length == 0) return {};
  if (is_too_long) {
    if (was_in_step) ++counts_.too_long;
    return {};
  }
  const auto plain_length = unstuff({stuffed_.data(), length}, plain_);
  if (plain_length && *plain_length > kCrcBytes && *plain_length <= kMostPlain) {
    const std::span<const std::uint8_t> payload(plain_.data(), *plain_length - kCrcBytes);
    std::uint32_t crc = 0;
    for (std::size_t i = 0; i < kCrcBytes; ++i) crc |= static_cast<std::uint32_t>(plain_[payload.size() + i]) << (8 * i);
    if (crc == crc32(payload)) {
      ++counts_.good;
      return payload;
    }
  }
  if (was_in_step) ++counts_.damaged;
  return {};
}

}  // namespace dts::device::board
