// SPDX-License-Identifier: Apache-2.0
#include "session/json_object.h"

#include <array>
#include <charconv>
#include <cmath>

namespace dts::session {
namespace {

/// RFC 8259 section 7. Replaces bytes outside ASCII by '?': names of conditions are words from a protocol file, and invalid UTF-8 would
/// make the whole document unreadable.
std::string json_text(std::string_view words) {
  std::string text = "\"";
  for (const char letter : words) {
    const auto byte = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      text += '\\';
      text += letter;
    } else {
      text += byte < 0x20 || byte > 0x7e ? '?' : letter;
    }
  }
  return text + '"';
}

}  // namespace

void JsonObject::add(std::string_view name, double value) {
  if (!std::isfinite(value)) return;
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  add_json(name, std::string(digits.data(), end));
}

void JsonObject::add(std::string_view name, std::optional<double> value) {
  if (value) add(name, *value);
}

void JsonObject::add(std::string_view name, std::size_t count) { add_json(name, std::to_string(count)); }

void JsonObject::add(std::string_view name, const std::string& words) { add_json(name, json_text(words)); }

void JsonObject::add_json(std::string_view name, const std::string& json) {
  if (!members_.empty()) members_ += ',';
  members_ += json_text(name) + ":" + json;
}

}  // namespace dts::session
