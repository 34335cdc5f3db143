// SPDX-License-Identifier: Apache-2.0
#include "lab/force/number_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <utility>

#include "core/special_numbers.h"
#include "lab/force/force_file.h"

namespace dts::lab::force {
namespace {

constexpr std::size_t kLongestLine = 65536;
constexpr std::size_t kLongestNumberText = 64;
/// Bytes of memory for the numbers: cells that are not empty need at most 4 for each of the file, and a file may have some empty ones.
constexpr std::size_t kMemoryPerByte = 4;
constexpr std::size_t kMemoryOfEmptyCells = std::size_t{32} << 20U;

std::string_view trimmed(std::string_view text) {
  const auto is_outside = [](char letter) { return letter == ' ' || letter == '\t' || letter == '"' || letter == '\r'; };
  while (!text.empty() && is_outside(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_outside(text.back())) text.remove_suffix(1);
  return text;
}

/// Lines of a file, one after the other; they may end as on Windows.
class Lines {
 public:
  explicit Lines(const std::string& file) : stream_(file, std::ios::binary) {}

  /// Returns false at the end, and if a line is too long: see `is_too_long`.
  bool next(std::string& line) {
    line.clear();
    int letter = 0;
    auto* const buffer = stream_.rdbuf();
    while ((letter = buffer->sbumpc()) != std::char_traits<char>::eof() && letter != '\n') {
      if (line.size() == kLongestLine) {
        is_too_long = true;
        return false;
      }
      line += static_cast<char>(letter);
    }
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return letter != std::char_traits<char>::eof() || !line.empty();
  }

  std::size_t number = 0;  ///< Of the last line, counted from 1.
  bool is_too_long = false;

 private:
  std::ifstream stream_;
};

/// Why a row cannot be read.
struct WrongRow {
  std::size_t column = 1;
  std::string text;
};

std::optional<WrongRow> read_row(std::string_view line, char separator, const std::vector<std::size_t>& places, std::size_t row_cells,
                                 std::vector<double>& row) {
  const auto cells = cells_of(line, separator);
  if (cells.size() < row_cells) {
    return WrongRow{.text = std::to_string(cells.size()) + " cells, but " + std::to_string(row_cells) + " names"};
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (places[k] >= cells.size()) {
      return WrongRow{.text = std::to_string(cells.size()) + " cells, the row needs " + std::to_string(places[k] + 1)};
    }
    const TextCell& cell = cells[places[k]];
    bool is_number = false;
    row[k] = number_of(cell.text, separator, is_number);
    if (!is_number) return WrongRow{.column = cell.column, .text = "'" + std::string(cell.text.substr(0, 40)) + "' is not a number"};
  }
  return std::nullopt;
}

tl::unexpected<core::Error> too_long(const std::string& file, std::size_t line) {
  return unreadable(file, "line " + std::to_string(line + 1) + " is longer than 64 KiB", "give a text export of a force plate");
}

}  // namespace

std::vector<TextCell> cells_of(std::string_view line, char separator) {
  std::vector<TextCell> cells;
  if (separator == ' ') {
    for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos; at = line.find_first_not_of(" \t", at)) {
      const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
      cells.push_back({trimmed(line.substr(at, end - at)), at + 1});
      at = end;
    }
    return cells;
  }
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    cells.push_back({trimmed(line.substr(at, end - at)), at + 1});
    at = end + 1;
  }
  return cells;
}

double number_of(std::string_view text, char separator, bool& is_number) {
  is_number = true;
  if (text.empty()) return core::kNaN;
  if (text.front() == '+') text.remove_prefix(1);
  std::array<char, kLongestNumberText> copy{};
  if (text.size() <= copy.size() && separator != ',' && text.find(',') != std::string_view::npos &&
      text.find('.') == std::string_view::npos) {
    std::ranges::copy(text, copy.begin());
    copy.at(text.find(',')) = '.';
    text = {copy.data(), text.size()};
  }
  double value = core::kNaN;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  is_number = error == std::errc{} && end == text.data() + text.size();  // "nan" and "inf" are read, too
  return is_number && std::isfinite(value) ? value : core::kNaN;
}

core::Result<Beginning> read_beginning(const std::string& file) {
  Lines lines(file);
  Beginning beginning;
  std::size_t bytes = 0;
  for (std::string line; beginning.lines.size() < kMostHeadLines && bytes < kLongestLine;) {
    if (!lines.next(line)) {
      if (lines.is_too_long) return too_long(file, lines.number);
      beginning.is_whole = true;
      break;
    }
    bytes += line.size() + 1;
    if (beginning.lines.empty() && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    beginning.lines.push_back(std::move(line));
  }
  return beginning;
}

core::Result<NumberColumns> read_columns(const std::string& file, std::size_t first_line, char separator,
                                         const std::vector<std::size_t>& places, std::size_t row_cells) {
  std::size_t last_line = 0;  // with text
  std::size_t bytes = 0;
  {
    Lines lines(file);
    for (std::string line; lines.next(line);) {
      bytes += line.size() + 1;
      if (!trimmed(line).empty()) last_line = lines.number;
    }
    if (lines.is_too_long) return too_long(file, lines.number);
  }
  if (last_line < first_line) return unreadable(file, "has no row of numbers below the names of the columns", "export the file again");
  const std::size_t rows = last_line - first_line + 1;
  if (rows * places.size() * sizeof(double) > kMemoryPerByte * bytes + kMemoryOfEmptyCells) {
    return unreadable(file, "line " + std::to_string(first_line) + ": almost all cells of the " + std::to_string(rows) + " rows are empty",
                      "remove the empty rows, or export the file again");
  }
  NumberColumns read{.columns = std::vector<std::vector<double>>(places.size()), .warnings = {}};
  for (auto& column : read.columns) column.reserve(rows);
  Lines lines(file);
  std::vector<double> row(places.size());
  for (std::string line; lines.number < last_line && lines.next(line);) {
    if (lines.number < first_line) continue;
    if (const auto wrong = read_row(line, separator, places, row_cells, row)) {
      if (lines.number == last_line && rows > 1) {
        read.warnings.push_back("line " + std::to_string(lines.number) + " is not complete and is left out: the file is cut off");
        break;
      }
      return unreadable(file, "line " + std::to_string(lines.number) + ", column " + std::to_string(wrong->column) + ": " + wrong->text,
                        "correct the line, or export the file again");
    }
    for (std::size_t k = 0; k < row.size(); ++k) read.columns[k].push_back(row[k]);
  }
  return read;
}

}  // namespace dts::lab::force
