// SPDX-License-Identifier: Apache-2.0
#include "cli/table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>

#include "core/utf8.h"

namespace dts::cli {
namespace {

constexpr std::string_view kBetween = "  ";  ///< Between two columns.
constexpr std::string_view kFolded = "  ";   ///< Indents the continued lines of a row.

/// Returns the number of bytes in the first `columns` columns of UTF-8 text.
std::size_t bytes_of(std::string_view text, std::size_t columns) noexcept {
  std::size_t bytes = 0;
  for (std::size_t shown = 0; bytes < text.size(); ++bytes) {
    if (core::starts_character(text[bytes]) && ++shown > columns) break;
  }
  return bytes;
}

}  // namespace

std::string decimal(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 512> text{};  // the largest double has 309 digits
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, decimals).ptr;
  const std::string_view shown(text.data(), end);
  return std::string(shown.find_first_not_of("-0.") == std::string_view::npos && shown.front() == '-' ? shown.substr(1) : shown);
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0.0 || seconds > 1e12) return "-";
  if (seconds < 59.95) return decimal(seconds, 1) + " s";  // more would be rounded to 60.0
  const auto whole = std::max(60LL, static_cast<long long>(seconds));
  const auto pair = [](long long large, const char* large_unit, long long small, const char* small_unit) {
    return std::to_string(large) + " " + large_unit + " " + std::to_string(small) + " " + small_unit;
  };
  if (whole < 3600) return pair(whole / 60, "min", whole % 60, "s");
  if (whole < 86400) return pair(whole / 3600, "h", whole % 3600 / 60, "min");
  return pair(whole / 86400, "d", whole % 86400 / 3600, "h");
}

std::size_t width(std::string_view text) noexcept { return core::character_count(text); }

std::vector<std::string> filled(const std::vector<std::string>& pieces, std::string_view separator, std::size_t columns,
                                std::string_view indent) {
  columns = std::max(columns, indent.size() + 1);
  std::vector<std::string> lines{""};
  bool is_begun = false;
  for (std::string_view piece : pieces) {
    const std::size_t added = width(piece) + (is_begun ? separator.size() : 0);
    if (is_begun && width(lines.back()) + added > columns) {
      while (lines.back().ends_with(' ')) lines.back().pop_back();
      lines.emplace_back(indent);
      is_begun = false;
    }
    if (is_begun) lines.back() += separator;
    is_begun = true;
    for (std::size_t room = columns - width(lines.back()); width(piece) > room; room = columns - indent.size()) {
      const std::size_t bytes = bytes_of(piece, room);
      lines.back() += piece.substr(0, bytes);
      piece.remove_prefix(bytes);
      lines.emplace_back(indent);
    }
    lines.back() += piece;
  }
  return lines;
}

std::vector<std::string> wrapped(std::string_view text, std::size_t columns, std::string_view indent) {
  if (width(text) <= columns) return {std::string(text)};  // unchanged: spaces may have a meaning
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return filled(words, " ", columns, indent);
}

std::string wrapped_at(const Console& console, std::size_t column, std::string_view text) {
  constexpr std::size_t kNarrowest = 20;  // in less room, wrapping makes a text harder to read
  if (!console.is_out_terminal || console.columns < column + kNarrowest) return std::string(text);
  return join(wrapped(text, console.columns - column, ""), "\n" + std::string(column, ' '));
}

Table::Table(std::vector<std::string> headers) {
  for (std::string& header : headers) {
    const bool is_right = header.starts_with('>');
    is_right_.push_back(is_right);
    headers_.push_back({is_right ? header.substr(1) : std::move(header), Style::Faint});
    widths_.push_back(width(headers_.back().text));
  }
}

void Table::add(std::vector<Cell> row) {
  row.resize(headers_.size());
  for (std::size_t column = 0; column < row.size(); ++column) {
    row[column].text = printable(row[column].text);
    widths_[column] = std::max(widths_[column], width(row[column].text));
  }
  rows_.push_back(std::move(row));
}

void Table::may_drop(const std::vector<std::string>& headers) {
  for (const std::string& header : headers) {
    const auto found = std::ranges::find(headers_, header, &Cell::text);
    if (found != headers_.end()) droppable_.push_back(static_cast<std::size_t>(found - headers_.begin()));
  }
}

std::vector<std::size_t> Table::empty_columns() const {
  std::vector<std::size_t> empty;
  for (std::size_t column = headers_.size(); column-- > 1;) {  // the first column names the row
    const auto is_empty = [column](const std::vector<Cell>& row) { return row[column].text.empty() || row[column].text == "-"; };
    if (std::ranges::all_of(rows_, is_empty)) empty.push_back(column);
  }
  return empty;
}

std::vector<std::size_t> Table::shown_columns(const Console& console) const {
  std::vector<std::size_t> shown(widths_.size());
  std::iota(shown.begin(), shown.end(), std::size_t{0});
  const auto is_too_wide = [&] {
    std::size_t used = 0;
    for (const std::size_t column : shown) used += widths_[column] + (used > 0 ? kBetween.size() : 0);
    return console.is_out_terminal && used > console.columns;
  };
  std::vector<std::size_t> order = empty_columns();
  order.insert(order.end(), droppable_.begin(), droppable_.end());
  for (auto next = order.begin(); next != order.end() && is_too_wide(); ++next) std::erase(shown, *next);
  return shown;
}

std::vector<std::size_t> Table::line_borders(const Console& console, std::span<const std::size_t> shown) const {
  std::vector<std::size_t> borders{0};
  std::size_t used = 0;
  for (std::size_t place = 0; place < shown.size() && console.is_out_terminal; ++place) {
    const std::size_t width = widths_[shown[place]];
    const bool is_first = place == borders.back();
    if (!is_first && used + kBetween.size() + width > console.columns) {
      borders.push_back(place);
      used = kFolded.size() + width;
    } else {
      used += (is_first ? 0 : kBetween.size()) + width;
    }
  }
  borders.push_back(shown.size());
  return borders;
}

void Table::print(Console& console) const {
  if (rows_.empty()) return;
  const std::vector<std::size_t> shown = shown_columns(console);
  const std::vector<std::size_t> borders = line_borders(console, shown);
  const auto print_row = [&](const std::vector<Cell>& cells) {
    for (std::size_t k = 0; k + 1 < borders.size(); ++k) {
      const std::string text = line(console, cells, std::span(shown).subspan(borders[k], borders[k + 1] - borders[k]));
      if (k == 0) console.out << text << '\n';
      if (k > 0 && !text.empty()) console.out << kFolded << text << '\n';
    }
  };
  print_row(headers_);
  for (const auto& row : rows_) print_row(row);
}

std::string Table::line(const Console& console, const std::vector<Cell>& cells, std::span<const std::size_t> columns) const {
  std::string text;
  for (const std::size_t column : columns) {
    const std::string padding(widths_[column] - width(cells[column].text), ' ');
    const std::string shown = cells[column].text.empty() ? "" : styled(console, cells[column].style, cells[column].text);
    const bool is_last = column == columns.back();
    if (is_right_[column]) {
      text += padding + shown;
    } else {
      text += is_last ? shown : shown + padding;
    }
    if (!is_last) text += kBetween;
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace dts::cli
