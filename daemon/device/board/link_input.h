// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/clock.h"
#include "device/bytes/byte_link.h"

namespace dts::device::board {

/// The pieces (frames or lines) of a link, one after the other. Thread: one at a time. Realtime-safe: yes.
template <class Decoder>
class LinkInput {
 public:
  LinkInput(bytes::ByteLink& link, core::Clock& clock, Decoder decoder = {}) noexcept
      : link_(&link), clock_(&clock), decoder_(std::move(decoder)) {}

  struct Next {
    bytes::ReadEnd end = bytes::ReadEnd::Timeout;  ///< Bytes: `piece` is one.
    typename Decoder::Taken piece;                 ///< Valid until the next call.
    std::int64_t raw_ns = 0;                       ///< When the bytes that end the piece were found waiting.
  };

  /// Waits for the next piece until `deadline_ns`. A piece that has arrived is returned also after the deadline.
  [[nodiscard]] Next next(std::int64_t deadline_ns) noexcept {
    while (true) {
      while (used_ < count_) {
        const typename Decoder::Taken piece = decoder_.take({buffer_.data() + used_, count_ - used_});
        used_ += piece.used;
        if (piece.has_piece()) return {bytes::ReadEnd::Bytes, piece, raw_ns_};
      }
      const bytes::BytesRead read = link_->read(buffer_, deadline_ns);
      if (read.end != bytes::ReadEnd::Bytes) return {read.end, {}, 0};
      used_ = 0;
      count_ = std::min(read.count, buffer_.size());
      raw_ns_ = read.raw_ns;
      byte_count_ += count_;
      if (clock_->now_ns() < deadline_ns) continue;
      const typename Decoder::Taken piece = decoder_.take({buffer_.data(), count_});  // garbage without end must not keep the caller
      used_ = piece.used;
      return {piece.has_piece() ? bytes::ReadEnd::Bytes : bytes::ReadEnd::Timeout, piece, raw_ns_};
    }
  }

  /// Drops what has arrived: at most a second of it, if more arrives all the time. Returns false if the link is lost.
  bool drain() noexcept {
    used_ = count_ = 0;
    decoder_.restart();
    const std::int64_t until_ns = clock_->now_ns() + core::kNanosecondsPerSecond;
    for (int i = 0; i < kMostReads && clock_->now_ns() < until_ns; ++i) {
      const bytes::BytesRead read = link_->read(buffer_, clock_->now_ns());
      if (read.end == bytes::ReadEnd::Lost) return false;
      if (read.end == bytes::ReadEnd::Timeout) return true;  // an interrupt does not mean that nothing waits
    }
    return true;
  }

  [[nodiscard]] const Decoder& decoder() const noexcept { return decoder_; }
  /// Number of bytes that have arrived.
  [[nodiscard]] std::uint64_t byte_count() const noexcept { return byte_count_; }

 private:
  static constexpr int kMostReads = 1000;

  bytes::ByteLink* link_;
  core::Clock* clock_;
  Decoder decoder_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::size_t used_ = 0;
  std::size_t count_ = 0;
  std::int64_t raw_ns_ = 0;
  std::uint64_t byte_count_ = 0;
};

}  // namespace dts::device::board
