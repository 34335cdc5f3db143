// SPDX-License-Identifier: Apache-2.0
#include "core/utf8.h"

namespace dts::core {
namespace {

struct Utf8Start {
  std::size_t length = 0;  ///< Number of bytes; 0: not the first byte of a character.
  std::uint32_t first_bits = 0;
  std::uint32_t smallest = 0;  ///< Smallest code of this length; a smaller code is an overlong form.
};

Utf8Start start_of(unsigned char first) noexcept {
  if (first < 0x80U) return {1, first, 0};
  if ((first & 0xE0U) == 0xC0U) return {2, first & 0x1FU, 0x80};
  if ((first & 0xF0U) == 0xE0U) return {3, first & 0x0FU, 0x800};
  if ((first & 0xF8U) == 0xF0U) return {4, first & 0x07U, 0x10000};
  return {};
}

bool drives_a_terminal(std::uint32_t code) noexcept {
  const bool is_control = code < 0x20 || (code >= 0x7F && code <= 0x9F);
  const bool is_direction =
      code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return is_control || is_direction;
}

}  // namespace

Utf8Character first_character(std::string_view text) noexcept {
  const Utf8Start start = start_of(static_cast<unsigned char>(text.front()));
  if (start.length == 0 || start.length > text.size()) return {};
  std::uint32_t code = start.first_bits;
  for (const char byte : text.substr(1, start.length - 1)) {
    const auto bits = static_cast<unsigned char>(byte);
    if ((bits & 0xC0U) != 0x80U) return {};
    code = (code << 6U) | (bits & 0x3FU);
  }
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < start.smallest || is_surrogate || code > 0x10FFFF) return {};
  return {.length = start.length, .code = code};
}

std::string printable(std::string_view text) {
  std::string safe;
  while (!text.empty()) {
    const Utf8Character first = first_character(text);
    if (first.length == 0) {
      safe += kReplacementCharacter;
      text.remove_prefix(1);
      continue;
    }
    if (drives_a_terminal(first.code)) {
      safe += ' ';
    } else {
      safe += text.substr(0, first.length);
    }
    text.remove_prefix(first.length);
  }
  return safe;
}

}  // namespace dts::core
