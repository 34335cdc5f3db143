// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "device/board/cobs.h"

namespace dts::device::board {

/// Numbers of input pieces since the link was opened.
struct InputCounts {
  std::uint64_t good = 0;
  std::uint64_t damaged = 0;   ///< Wrong checksum, wrong stuffing, not a line of numbers.
  std::uint64_t too_long = 0;  ///< Longer than a frame or a line can be.
  std::uint64_t rejected = 0;  ///< Undamaged, but a field or the number of columns is wrong.
};

/// Finds the frames in a stream of bytes. After damage it continues behind the next 0x00. Realtime-safe: yes.
class FrameDecoder {
 public:
  struct Taken {
    std::size_t used = 0;                   ///< Bytes of the input that are done.
    std::span<const std::uint8_t> payload;  ///< The payload of one good frame, valid until the next call; empty: all input is used.
    [[nodiscard]] bool has_piece() const noexcept { return !payload.empty(); }
  };
  /// Takes bytes up to the end of the next good frame.
  [[nodiscard]] Taken take(std::span<const std::uint8_t> bytes) noexcept;
  /// Forgets an incomplete frame: the next bytes begin anywhere in the stream.
  void restart() noexcept;
  [[nodiscard]] const InputCounts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] std::span<const std::uint8_t> finish() noexcept;

  std::array<std::uint8_t, kMostStuffed> stuffed_{};
  std::array<std::uint8_t, kMostStuffed> plain_{};
  std::size_t length_ = 0;
  bool is_too_long_ = false;
  bool is_in_step_ = false;  ///< A 0x00 has been seen: damage before it is only a cut frame.
  InputCounts counts_;
};

}  // namespace dts::device::board
