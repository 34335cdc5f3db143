// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/block.h"
#include "device/board/frame_decoder.h"

namespace dts::device::board {

inline constexpr std::size_t kMostLine = 512;  ///< Bytes of a line, without its end.

/// What the first column of a line is.
enum class FirstColumn : std::uint8_t { Value, Counter, TimeUs };

/// One good line.
struct Line {
  std::uint32_t position = 0;  ///< The counter, or the time in us; 0 if the first column is a value.
  std::array<double, core::kMaxChannels> values{};
};

/// Finds the lines in a stream of bytes and reads their numbers. Realtime-safe: yes.
class LineDecoder {
 public:
  /// `channels`: values in a line, 1 to 32. `counter_bits`: 16 or 32.
  LineDecoder(std::size_t channels, FirstColumn first_column, unsigned counter_bits) noexcept
      : channels_(channels), first_column_(first_column), counter_bits_(counter_bits) {}

  struct Taken {
    std::size_t used = 0;  ///< Bytes of the input that are done.
    bool is_line = false;  ///< A line has ended.
    bool is_good = false;  ///< `line` holds its numbers; false: the line is lost.
    [[nodiscard]] bool has_piece() const noexcept { return is_line; }
  };
  /// Takes bytes up to the end of the next line. Empty lines are skipped.
  [[nodiscard]] Taken take(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] const Line& line() const noexcept { return line_; }
  /// The next line may be cut at its beginning: it is dropped.
  void restart() noexcept;
  [[nodiscard]] const InputCounts& counts() const noexcept { return counts_; }
  /// Returns the number of columns of the last line whose number of columns was wrong; 0: none so far.
  [[nodiscard]] std::size_t wrong_columns() const noexcept { return wrong_columns_; }

 private:
  [[nodiscard]] bool parse(std::string_view text) noexcept;
  [[nodiscard]] bool has_right_checksum(std::string_view& text) noexcept;
  [[nodiscard]] bool add_column(std::size_t column, std::string_view text) noexcept;

  std::size_t channels_;
  FirstColumn first_column_;
  unsigned counter_bits_;
  std::array<char, kMostLine + 1> text_{};  ///< One more for the CR.
  std::size_t length_ = 0;
  bool is_too_long_ = false;
  bool is_first_ = true;
  bool has_checksums_ = false;  ///< A line had a right checksum: from then on every line needs one.
  Line line_;
  std::size_t wrong_columns_ = 0;
  InputCounts counts_;
};

}  // namespace dts::device::board
