// SPDX-License-Identifier: Apache-2.0
#include "visits/sentences.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace dts::visits {
namespace {

std::string with_capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

}  // namespace

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
  return with_capital(std::move(spoken));
}

std::string stance_words(const std::string& labels, const Sentences& sentences) {
  std::string words;
  for (std::size_t begin = 0; begin < labels.size();) {
    const std::size_t end = std::min(labels.find(',', begin), labels.size());
    const std::string label = labels.substr(begin, end - begin);
    const std::size_t equals = std::min(label.find('='), label.size());
    const std::string name = label.substr(0, equals);
    const std::string value = equals < label.size() ? label.substr(equals + 1) : "";
    const std::string known = sentences.label(name, value);
    words += (words.empty() ? "" : ", ") + (!known.empty() ? known : value.empty() ? name : name + " " + value);
    begin = end + 1;
  }
  return with_capital(std::move(words));
}

}  // namespace dts::visits
