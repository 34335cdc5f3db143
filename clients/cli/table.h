// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/console.h"

namespace dts::cli {

/// A number for people: fixed decimals; "-" for what is undefined.
[[nodiscard]] std::string decimal(double value, int decimals);
/// "12.3 s", "4 min 5 s", "3 h 12 min", "2 d 3 h".
[[nodiscard]] std::string duration(double seconds);
/// Columns that `text` takes on a terminal (code points of UTF-8).
[[nodiscard]] std::size_t width(std::string_view text) noexcept;

struct Cell {
  std::string text;
  Style style = Style::Plain;
};

/// Text in columns. A header that starts with '>' makes its column right-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> headers);
  /// Missing cells are empty; more cells than headers are ignored.
  void add(std::vector<Cell> row);
  /// To `console.out`; nothing at all without rows.
  void print(Console& console) const;
  /// The same in at most `columns` characters: what does not fit goes into further tables below, each with the first column again and an
  /// empty line in front. A single cell may be wider.
  void print_folded(Console& console, std::size_t columns) const;

 private:
  /// The first column and those from `begin` to `end`.
  [[nodiscard]] std::string line(const Console& console, const std::vector<Cell>& cells, std::size_t begin, std::size_t end) const;
  void print(Console& console, std::size_t begin, std::size_t end) const;

  std::vector<Cell> headers_;
  std::vector<bool> is_right_;
  std::vector<std::size_t> widths_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace dts::cli
