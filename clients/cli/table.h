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

/// The pieces in a row, in lines of at most `columns` columns; all but the first line begin with `indent`. A piece that is wider than a
/// line is split.
[[nodiscard]] std::vector<std::string> filled(const std::vector<std::string>& pieces, std::string_view separator, std::size_t columns,
                                              std::string_view indent);
/// The same of the words of a text.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t columns, std::string_view indent);

struct Cell {
  std::string text;
  Style style = Style::Plain;
};

/// Text in columns. A header that starts with '>' makes its column right-aligned. On a terminal that is too narrow, the last columns
/// stand in lines of their own below the first ones:
///
///     SESSION                   RIG    STARTED (UTC)
///       STATE     LABEL
///     20261121T234254Z-floor-1  floor  2026-11-21 23:42:54
///       complete  first try
class Table {
 public:
  explicit Table(std::vector<std::string> headers);
  /// Missing cells are empty; more cells than headers are ignored.
  void add(std::vector<Cell> row);
  /// To `console.out`; nothing at all without rows.
  void print(Console& console) const;

 private:
  /// The first column of each line of a row, and behind them the number of columns.
  [[nodiscard]] std::vector<std::size_t> line_borders(const Console& console) const;
  [[nodiscard]] std::string line(const Console& console, const std::vector<Cell>& cells, std::size_t begin, std::size_t end) const;

  std::vector<Cell> headers_;
  std::vector<bool> is_right_;
  std::vector<std::size_t> widths_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace dts::cli
