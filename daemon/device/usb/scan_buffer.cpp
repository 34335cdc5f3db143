// SPDX-License-Identifier: Apache-2.0
#include "device/usb/scan_buffer.h"

#include <algorithm>

namespace dts::device::usb {

std::span<std::uint16_t> ScanBuffer::room() noexcept {
  if (begin_ == end_) {
    begin_ = end_ = 0;
  } else if (begin_ > 0 && codes_.size() - end_ < codes_.size() / 2) {
    // Codes are moved only if little space is left at the end, so the cost per code is constant.
    std::copy(codes_.begin() + static_cast<std::ptrdiff_t>(begin_), codes_.begin() + static_cast<std::ptrdiff_t>(end_), codes_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  return {codes_.data() + end_, codes_.size() - end_};
}

void ScanBuffer::add(std::size_t count) noexcept { end_ += std::min(count, codes_.size() - end_); }

void ScanBuffer::drop_incomplete() noexcept { end_ = begin_ + scans() * channels_; }

void ScanBuffer::clear() noexcept { begin_ = end_ = 0; }

}  // namespace dts::device::usb
