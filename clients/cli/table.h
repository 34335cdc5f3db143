// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/console.h"

namespace dts::cli {

/// Returns a number for people, with fixed decimals; "-" if it is undefined.
[[nodiscard]] std::string decimal(double value, int decimals);
/// Returns "12.3 s", "4 min 5 s", "3 h 12 min", "2 d 3 h".
[[nodiscard]] std::string duration(double seconds);
/// Returns the number of columns that `text` needs on a terminal (code points of UTF-8).
[[nodiscard]] std::size_t width(std::string_view text) noexcept;

/// Joins the pieces into lines of at most `columns` columns; all lines but the first begin with `indent`. A piece wider than a line is
/// split.
[[nodiscard]] std::vector<std::string> filled(const std::vector<std::string>& pieces, std::string_view separator, std::size_t columns,
                                              std::string_view indent);
/// The same for the words of a text.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t columns, std::string_view indent);

/// Returns the text for a line of `console.out` whose first `column` columns are written already. On a terminal, the text is wrapped at
/// blanks and continues at the same column; elsewhere it stays one line.
[[nodiscard]] std::string wrapped_at(const Console& console, std::size_t column, std::string_view text);

struct Cell {
  std::string text;
  Style style = Style::Plain;
};

/// Text in columns. A header that starts with '>' makes its column right-aligned. On a terminal that is too narrow, columns that are empty
/// in all rows are dropped, then those that may be dropped; if this is not enough, the last columns move to separate lines below the first
/// ones. Nothing is cut:
///
///     SESSION                   RIG    STARTED (UTC)
///       STATE     LABEL
///     20261121T234254Z-floor-1  floor  2026-11-21 23:42:54
///       complete  first try
class Table {
 public:
  explicit Table(std::vector<std::string> headers);
  /// Names the columns that a narrow terminal drops, the least important first: headers without '>'.
  void may_drop(const std::vector<std::string>& headers);
  /// Missing cells are empty; more cells than headers are ignored.
  void add(std::vector<Cell> row);
  /// Prints to `console.out`; prints nothing if there are no rows.
  void print(Console& console) const;

 private:
  /// Returns the columns, except the first, that are empty or "-" in all rows; the last one first.
  [[nodiscard]] std::vector<std::size_t> empty_columns() const;
  /// Returns the columns that are shown.
  [[nodiscard]] std::vector<std::size_t> shown_columns(const Console& console) const;
  /// Returns the first of the `shown` columns of each line of a row, then their number.
  [[nodiscard]] std::vector<std::size_t> line_borders(const Console& console, std::span<const std::size_t> shown) const;
  [[nodiscard]] std::string line(const Console& console, const std::vector<Cell>& cells, std::span<const std::size_t> columns) const;

  std::vector<Cell> headers_;
  std::vector<bool> is_right_;
  std::vector<std::size_t> widths_;
  std::vector<std::size_t> droppable_;  ///< Columns, the least important first.
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace dts::cli
