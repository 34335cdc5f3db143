// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace dts::record {

/// Reads the whole text as a number, independent of the locale. Returns nothing if it is no number or does not fit the type.
template <class Number>
[[nodiscard]] std::optional<Number> number_of(std::string_view text) noexcept {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return number;
}

/// Returns 17 significant digits, which read back as exactly the same double.
[[nodiscard]] inline std::string text_of_double(double value) {
  std::array<char, 40> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, std::numeric_limits<double>::max_digits10);
  return error == std::errc{} ? std::string(text.data(), end) : std::string("nan");
}

/// Returns the shortest text that reads back as exactly the same double.
[[nodiscard]] inline std::string shortest_text(double value) {
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::string("nan");
}

}  // namespace dts::record
