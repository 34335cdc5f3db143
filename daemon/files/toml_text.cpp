// SPDX-License-Identifier: Apache-2.0
#include "files/toml_text.h"

#include <toml++/toml.h>
#include <array>
#include <charconv>
#include <sstream>

namespace dts::files {

std::string toml_number(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  const std::string text(buffer.data(), end);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;  // without '.' or 'e' TOML reads an integer
}

std::string toml_numbers(std::span<const double> values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() == 1 ? "" : ", ") + toml_number(value);
  return text + "]";
}

std::string toml_quoted(std::string_view text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

}  // namespace dts::files
