// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::lab::force {

/// One cell and its first column, counted from 1.
struct TextCell {
  std::string_view text;
  std::size_t column = 1;
};

/// Splits a line at `separator`; ' ' means any number of spaces and tabs. Removes spaces and quotes around a cell.
[[nodiscard]] std::vector<TextCell> cells_of(std::string_view line, char separator);

/// Reads a number; a comma is a decimal comma unless it separates cells. Returns NaN for an empty cell and for "nan". Sets `is_number` to
/// false if the text is something else.
[[nodiscard]] double number_of(std::string_view text, char separator, bool& is_number);

/// The first lines of a text file, without line ends: where its names are.
struct Beginning {
  std::vector<std::string> lines;
  bool is_whole = false;  ///< The file has no other lines.
};
inline constexpr std::size_t kMostHeadLines = 300;

/// Reads at most `kMostHeadLines` lines of at most 64 KiB together. Fails with Failed.
[[nodiscard]] core::Result<Beginning> read_beginning(const std::string& file);

/// Columns of numbers below the names. All have the same length.
struct NumberColumns {
  std::vector<std::vector<double>> columns;  ///< In the order of `places`.
  std::vector<std::string> warnings;
};

/// Reads the columns at `places` (counted from 0) of all rows from line `first_line` (counted from 1). Reads the file twice, so that it
/// needs no more memory than its numbers. Empty lines at the end are ignored. A last row with too few cells is left out, with a warning.
/// Fails with Failed, naming line and column, if another row has fewer than `row_cells` cells or not the last place, or if a cell is not a
/// number; also if there is no row, and if almost all cells are empty, so that the numbers need much more memory than the file has bytes.
[[nodiscard]] core::Result<NumberColumns> read_columns(const std::string& file, std::size_t first_line, char separator,
                                                       const std::vector<std::size_t>& places, std::size_t row_cells = 0);

}  // namespace dts::lab::force
