// SPDX-License-Identifier: Apache-2.0
#include "device/board/line_decoder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace dts::device::board {
namespace {

constexpr bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }
constexpr bool is_separator(char c) noexcept { return c == ',' || is_blank(c); }

template <class Number, class... Base>
std::optional<Number> number_of(std::string_view text, Base... base) noexcept {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, number, base...);
  if (error != std::errc{} || stopped_at != end) return std::nullopt;
  return number;
}

/// Cuts the first column off `rest`. Blanks around a comma belong to it: "1, 2" has two columns, "1,,2" three.
std::string_view cut_column(std::string_view& rest, bool& has_next) noexcept {
  const std::size_t end = static_cast<std::size_t>(std::ranges::find_if(rest, is_separator) - rest.begin());
  const std::string_view column = rest.substr(0, end);
  std::size_t next = end;
  while (next < rest.size() && is_blank(rest[next])) ++next;
  const bool has_comma = next < rest.size() && rest[next] == ',';
  if (has_comma) ++next;
  while (next < rest.size() && is_blank(rest[next])) ++next;
  has_next = has_comma || next < rest.size();
  rest.remove_prefix(next);
  return column;
}

}  // namespace

void LineDecoder::restart() noexcept {
  length_ = 0;
  is_too_long_ = false;
  is_first_ = true;
}

LineDecoder::Taken LineDecoder::take(std::span<const std::uint8_t> bytes) noexcept {
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const char c = static_cast<char>(bytes[at]);
    if (c != '\n') {
      if (length_ < text_.size()) {
        text_[length_++] = c;
      } else {
        is_too_long_ = true;
      }
      continue;
    }
    std::string_view text(text_.data(), std::exchange(length_, 0));
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    const bool is_too_long = std::exchange(is_too_long_, false) || text.size() > kMostLine;
    if (std::exchange(is_first_, false)) continue;
    if (text.empty() && !is_too_long) continue;
    if (is_too_long) ++counts_.too_long;
    const bool is_good = !is_too_long && parse(text);
    if (is_good) ++counts_.good;
    return {at + 1, true, is_good};
  }
  return {bytes.size(), false, false};
}

/// Removes "*hh" from the end of `text` if it is there. Returns false if it is wrong, or missing after a line that had one.
bool LineDecoder::has_right_checksum(std::string_view& text) noexcept {
  const std::size_t star = text.find('*');
  if (star == std::string_view::npos) return !has_checksums_;
  if (text.size() - star != 3) return false;
  const auto expected = number_of<unsigned>(text.substr(star + 1), 16);
  unsigned found = 0;
  for (const char c : text.substr(0, star)) found ^= static_cast<unsigned char>(c);
  if (expected != found) return false;
  has_checksums_ = true;
  text = text.substr(0, star);
  return true;
}

bool LineDecoder::parse(std::string_view text) noexcept {
  if (!has_right_checksum(text)) {
    ++counts_.damaged;
    return false;
  }
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  const std::size_t wanted = channels_ + (first_column_ == FirstColumn::Value ? 0 : 1);
  std::size_t columns = 0;
  bool are_numbers = true;
  for (bool has_next = true; has_next; ++columns) {
    const std::string_view column = cut_column(text, has_next);
    const bool is_number = columns < wanted ? add_column(columns, column) : number_of<double>(column).has_value();
    are_numbers = are_numbers && is_number;
  }
  if (are_numbers && columns != wanted) {
    wrong_columns_ = columns;
    ++counts_.rejected;
    return false;
  }
  if (!are_numbers) ++counts_.damaged;
  return are_numbers;
}

bool LineDecoder::add_column(std::size_t column, std::string_view text) noexcept {
  if (column == 0 && first_column_ != FirstColumn::Value) {
    const auto position = number_of<std::uint32_t>(text, 10);
    if (!position || (first_column_ == FirstColumn::Counter && counter_bits_ == 16 && *position > 0xFFFFU)) return false;
    line_.position = *position;
    return true;
  }
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto value = number_of<double>(text, std::chars_format::general);
  if (!value || !std::isfinite(*value)) return false;
  line_.values[column - (first_column_ == FirstColumn::Value ? 0 : 1)] = *value;
  return true;
}

}  // namespace dts::device::board
