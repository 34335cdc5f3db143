// SPDX-License-Identifier: Apache-2.0
#include "cli/table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace dts::cli {
namespace {

constexpr std::size_t kGap = 2;  // between columns

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
  if (seconds < 60.0) return decimal(seconds, 1) + " s";
  const auto whole = static_cast<long long>(seconds);
  const auto pair = [](long long large, const char* large_unit, long long small, const char* small_unit) {
    return std::to_string(large) + " " + large_unit + " " + std::to_string(small) + " " + small_unit;
  };
  if (whole < 3600) return pair(whole / 60, "min", whole % 60, "s");
  if (whole < 86400) return pair(whole / 3600, "h", whole % 3600 / 60, "min");
  return pair(whole / 86400, "d", whole % 86400 / 3600, "h");
}

std::size_t width(std::string_view text) noexcept {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
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

void Table::print(Console& console) const { print(console, 1, headers_.size()); }

void Table::print_folded(Console& console, std::size_t columns) const {
  std::size_t begin = 1;
  do {
    std::size_t end = begin;
    std::size_t used = widths_.front();
    while (end < widths_.size() && (end == begin || used + kGap + widths_[end] <= columns)) used += kGap + widths_[end++];
    if (begin > 1 && !rows_.empty()) console.out << '\n';
    print(console, begin, end);
    begin = end;
  } while (begin < headers_.size());
}

void Table::print(Console& console, std::size_t begin, std::size_t end) const {
  if (rows_.empty()) return;
  console.out << line(console, headers_, begin, end) << '\n';
  for (const auto& row : rows_) console.out << line(console, row, begin, end) << '\n';
}

std::string Table::line(const Console& console, const std::vector<Cell>& cells, std::size_t begin, std::size_t end) const {
  std::string text;
  for (std::size_t column = 0; column < end; column = std::max(column + 1, begin)) {
    const std::string padding(widths_[column] - width(cells[column].text), ' ');
    const std::string shown = styled(console, cells[column].style, cells[column].text);
    const bool is_last = std::max(column + 1, begin) >= end;
    if (is_right_[column]) {
      text += padding + shown;
    } else {
      text += is_last ? shown : shown + padding;
    }
    if (!is_last) text += std::string(kGap, ' ');
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace dts::cli
