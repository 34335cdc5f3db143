// SPDX-License-Identifier: Apache-2.0
#include "lab/base/csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "core/cell_text.h"
#include "core/number_text.h"
#include "core/suggest.h"

namespace dts::lab {
namespace {

constexpr std::size_t kMostProblems = 100;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

/// Reads a table line by line.
class CsvTable::Reader {
 public:
  Reader(CsvTable& table, std::string file, files::Problems& problems)
      : table_(table), file_(std::move(file)), problems_(problems), problems_before_(problems.size()) {}

  void read() {
    if (!check_file()) return;
    std::ifstream stream(file_, std::ios::binary);
    std::string line;
    if (!stream) return report(0, 0, "cannot be read");
    if (!next(stream, line)) {
      if (is_well_) report(0, 0, "is empty");
      return;
    }
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark of spreadsheets
    read_header(line);
    while (is_going() && next(stream, line)) read_row(line);
    if (is_going() && table_.lines_.empty()) report(0, 0, "has no rows");
  }

 private:
  void report(std::size_t line, std::size_t column, const std::string& text) {
    problems_.push_back({file_, static_cast<std::uint32_t>(line), static_cast<std::uint32_t>(column), text});
  }
  [[nodiscard]] bool is_going() const { return is_well_ && problems_.size() - problems_before_ < kMostProblems; }

  bool check_file() {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file_, error)) {
      report(0, 0, "no such file");
      return false;
    }
    const auto bytes = std::filesystem::file_size(file_, error);
    if (!error && bytes <= kMostBytes) return true;
    report(0, 0, error ? error.message() : "is larger than " + std::to_string(kMostBytes >> 20U) + " MiB");
    return false;
  }

  bool next(std::ifstream& stream, std::string& line) {
    if (!std::getline(stream, line)) return false;
    ++line_number_;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.size() <= kLongestLine) return true;
    report(line_number_, kLongestLine, "longer than " + std::to_string(kLongestLine) + " characters");
    is_well_ = false;
    return false;
  }

  /// Reports an open quote: otherwise the rest of the line would become one cell.
  std::optional<std::vector<Cell>> closed_cells(const std::string& line) {
    auto cells = cells_of(line);
    if (cells.back().open_quote == 0) return cells;
    report(line_number_, cells.back().open_quote, "the quote is not closed on this line");
    return std::nullopt;
  }

  void read_header(const std::string& line) {
    table_.header_ = line;
    const auto closed = closed_cells(line);
    if (!closed) {
      is_well_ = false;
      return;
    }
    const auto& cells = *closed;
    column_count_ = cells.size();
    std::vector<std::string_view> names;
    for (std::size_t place = 0; place < cells.size(); ++place) {
      const std::string_view name = core::text_of_cell(trimmed(cells[place].text));
      if (std::ranges::find(names, name) != names.end()) report(1, cells[place].column, "column '" + std::string(name) + "' occurs twice");
      names.push_back(name);
      const auto known = std::ranges::find(table_.columns_, name, [](const Column& column) { return std::string_view(column.about.name); });
      if (known != table_.columns_.end()) known->place = place;
    }
    report_missing(names);
  }

  void report_missing(std::vector<std::string_view> names) {
    std::erase_if(names, [&](std::string_view name) { return table_.find(name) != nullptr; });  // these columns exist under their correct
                                                                                                // names
    for (const Column& column : table_.columns_) {
      if (column.place || !column.about.is_required) continue;
      const std::string near = core::suggest(column.about.name, names);
      report(1, 1, "column '" + column.about.name + "' is missing" + (near.empty() ? "" : "; did you mean '" + near + "'?"));
      is_well_ = false;
    }
  }

  void read_row(const std::string& line) {
    if (trimmed(line).empty()) return skip_empty_line();
    if (table_.lines_.size() == kMostRows) {
      report(line_number_, 1, "more than " + std::to_string(kMostRows) + " rows");
      is_well_ = false;
      return;
    }
    if (empty_line_ > 0) report(empty_line_, 1, "empty line between rows");
    empty_line_ = 0;
    const auto closed = closed_cells(line);
    if (!closed) return;
    const auto& cells = *closed;
    if (cells.size() != column_count_) {
      report(line_number_, 1, std::to_string(cells.size()) + " cells, the header has " + std::to_string(column_count_));
      return;
    }
    table_.lines_.push_back(line);
    for (Column& column : table_.columns_) {
      if (!column.place) continue;
      const Cell& cell = cells[*column.place];
      if (column.about.is_text) {
        column.texts.emplace_back(core::text_of_cell(cell.text));
      } else {
        column.numbers.push_back(number_of(column.about, cell));
      }
    }
  }

  /// Empty lines are allowed only at the end of the file.
  void skip_empty_line() {
    if (empty_line_ == 0) empty_line_ = line_number_;
  }

  double number_of(const CsvColumn& about, const Cell& cell) {
    constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
    const std::string_view text = trimmed(cell.text);
    const std::string& name = about.name;
    if (text.empty()) {
      if (!about.may_be_empty) report(line_number_, cell.column, name + " is empty");
      return kUndefined;
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
      report(line_number_, cell.column, name + ": '" + std::string(text.substr(0, 40)) + "' is not a finite number");
      return kUndefined;
    }
    if (value >= about.minimum && value <= about.maximum) return value;
    report(line_number_, cell.column,
           name + " = " + core::number_text(value) + " is out of range; allowed: " + core::number_text(about.minimum) + " .. " +
               core::number_text(about.maximum));
    return kUndefined;
  }

  CsvTable& table_;
  std::string file_;
  files::Problems& problems_;
  std::size_t problems_before_;
  std::size_t line_number_ = 0;
  std::size_t column_count_ = 0;
  std::size_t empty_line_ = 0;  ///< Line number of the first of the current empty lines; 0: none.
  bool is_well_ = true;
};

CsvTable CsvTable::read(const std::string& file, const std::vector<CsvColumn>& columns, files::Problems& problems) {
  CsvTable table;
  for (const CsvColumn& column : columns) table.columns_.push_back({.about = column});
  Reader(table, file, problems).read();
  return table;
}

std::vector<CsvTable::Cell> CsvTable::cells_of(std::string_view line) {
  std::vector<Cell> cells(1);
  bool is_quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"') {
      const bool is_doubled = is_quoted && k + 1 < line.size() && line[k + 1] == '"';
      if (is_doubled) {
        cells.back().text += line[++k];
      } else {
        is_quoted = !is_quoted;
        cells.back().open_quote = is_quoted ? k + 1 : 0;
      }
    } else if (line[k] == ',' && !is_quoted) {
      cells.push_back({.text = {}, .column = k + 2});
    } else {
      cells.back().text += line[k];
    }
  }
  return cells;
}

const CsvTable::Column* CsvTable::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(columns_, name, [](const Column& column) { return std::string_view(column.about.name); });
  return found == columns_.end() ? nullptr : &*found;
}

bool CsvTable::has(std::string_view column) const noexcept {
  const Column* found = find(column);
  return found != nullptr && found->place.has_value();
}

const std::vector<double>& CsvTable::numbers(std::string_view column) const {
  static const std::vector<double> none;
  const Column* found = find(column);
  return found == nullptr ? none : found->numbers;
}

const std::vector<std::string>& CsvTable::texts(std::string_view column) const {
  static const std::vector<std::string> none;
  const Column* found = find(column);
  return found == nullptr ? none : found->texts;
}

void add_csv_number(std::string& line, double value) {
  line += ',';
  if (!std::isfinite(value)) return;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9).ptr;
  line.append(text.data(), end);
}

}  // namespace dts::lab
