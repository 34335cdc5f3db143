// SPDX-License-Identifier: Apache-2.0
#include "core/cell_text.h"

#include <charconv>
#include <system_error>

namespace dts::core {
namespace {

bool starts_formula(std::string_view text) noexcept {
  constexpr std::string_view kStarts = "=+-@\t\r";
  if (text.empty() || kStarts.find(text.front()) == std::string_view::npos) return false;
  double number = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return read.ec != std::errc{} || read.ptr != text.data() + text.size();
}

}  // namespace

std::string as_cell(std::string_view text) { return (starts_formula(text) ? "'" : "") + std::string(text); }

std::string csv_cell(std::string_view given) {
  const std::string text = as_cell(given);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char letter : text) {
    if (letter == '"') cell += '"';
    cell += letter;
  }
  return cell + '"';
}

std::string_view text_of_cell(std::string_view cell) noexcept {
  return cell.starts_with('\'') && starts_formula(cell.substr(1)) ? cell.substr(1) : cell;
}

}  // namespace dts::core
