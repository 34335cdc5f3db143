// SPDX-License-Identifier: Apache-2.0
#include "visits/sentences.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace dts::visits {

long Change::percent() const { return from > 0.0 && std::isfinite(to / from) ? std::lround(100.0 * std::abs(to / from - 1.0)) : 0; }

const Sentences& sentences_in(std::string_view language) noexcept {
  return language == "de" || language.starts_with("de-") ? german() : english();
}

std::string figure(double value, int decimals, char decimal_sign) {
  if (!std::isfinite(value) || std::abs(value) > 1e9) return "-";
  std::array<char, 64> text{};
  const auto [end, failed] = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals);
  if (failed != std::errc()) return "-";
  std::string made(text.data(), end);
  if (made.find_first_not_of("-0.") == std::string::npos) std::erase(made, '-');  // no sign for zero
  std::ranges::replace(made, '.', decimal_sign);
  return made;
}

std::string spoken_condition(const std::string& name) {
  std::string spoken = name;
  std::ranges::replace(spoken, '-', ' ');
  std::ranges::replace(spoken, '_', ' ');
  if (!spoken.empty() && spoken[0] >= 'a' && spoken[0] <= 'z') spoken[0] = static_cast<char>(spoken[0] - 'a' + 'A');
  return spoken;
}

}  // namespace dts::visits
