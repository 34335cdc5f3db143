// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/toml_reader.h"

namespace dts::lab {

/// Allowed content of a column of a CSV file.
struct CsvColumn {
  std::string name;
  bool is_required = true;    ///< A missing column is a problem.
  bool may_be_empty = false;  ///< An empty cell becomes NaN.
  bool is_text = false;
  double minimum = -1e9;
  double maximum = 1e9;
};

/// A CSV file whose first line names its columns, in any order; other columns are ignored. Cells may be in double quotes; lines may end
/// as on Windows. Texts and names are those passed to `core::csv_cell` when the file was written.
class CsvTable {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 30U;
  static constexpr std::size_t kMostRows = 10'000'000;
  static constexpr std::size_t kLongestLine = 4096;

  /// Reads `file`. Adds every error (a missing column, a row of another length, a cell that is not a number, out of range or not finite, an
  /// open quote) to `problems` with file:line:column; stops after a hundred.
  [[nodiscard]] static CsvTable read(const std::string& file, const std::vector<CsvColumn>& columns, files::Problems& problems);

  [[nodiscard]] std::size_t row_count() const noexcept { return lines_.size(); }
  [[nodiscard]] bool has(std::string_view column) const noexcept;
  /// Returns the values of a requested numeric column, one per row; empty if the file does not have the column.
  [[nodiscard]] const std::vector<double>& numbers(std::string_view column) const;
  [[nodiscard]] const std::vector<std::string>& texts(std::string_view column) const;
  /// The header and the rows as written in the file, without line ends.
  [[nodiscard]] const std::string& header() const noexcept { return header_; }
  [[nodiscard]] const std::vector<std::string>& lines() const noexcept { return lines_; }
  /// Returns the line of the file, counted from 1.
  [[nodiscard]] static std::size_t line_of_row(std::size_t row) noexcept { return row + 2; }

 private:
  struct Column {
    CsvColumn about;
    std::optional<std::size_t> place;  ///< Index in the file.
    std::vector<double> numbers;
    std::vector<std::string> texts;
  };
  /// A cell and its first column, counted from 1.
  struct Cell {
    std::string text;
    std::size_t column = 1;
    std::size_t open_quote = 0;  ///< Position of a quote that is never closed; 0: none.
  };
  class Reader;

  [[nodiscard]] const Column* find(std::string_view name) const noexcept;
  [[nodiscard]] static std::vector<Cell> cells_of(std::string_view line);

  std::string header_;
  std::vector<std::string> lines_;
  std::vector<Column> columns_;
};

/// Appends a comma and the value with 9 digits to a line of a CSV file; an undefined value becomes an empty cell.
void add_csv_number(std::string& line, double value);

}  // namespace dts::lab
