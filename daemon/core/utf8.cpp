// SPDX-License-Identifier: Apache-2.0
#include "core/utf8.h"

#include <utf8cpp/utf8.h>

#include <algorithm>

namespace dts::core {
namespace {

bool leaves_a_terminal_alone(std::uint32_t code) noexcept {
  const bool is_control = code < 0x20 || (code >= 0x7F && code <= 0x9F);
  const bool is_direction =
      code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return !is_control && !is_direction;
}

}  // namespace

std::size_t character_count(std::string_view text) noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(text, starts_character));
}

bool is_utf8(std::string_view text) noexcept { return utf8::is_valid(text.begin(), text.end()); }

std::u32string characters_of(std::string_view text) {
  std::u32string characters;
  for (const char* at = text.data(); at != text.data() + text.size();) characters += utf8::unchecked::next(at);
  return characters;
}

std::string allowed_text(std::string_view text, bool (*is_allowed)(std::uint32_t code), std::string_view instead) {
  std::string allowed;
  allowed.reserve(text.size());
  const auto* at = text.data();
  const auto* const end = at + text.size();
  while (at != end) {
    for (const auto* const valid_end = utf8::find_invalid(at, end); at != valid_end;) {
      const auto* const start = at;
      const bool stays = is_allowed(utf8::unchecked::next(at));
      allowed += stays ? std::string_view(start, static_cast<std::size_t>(at - start)) : instead;
    }
    if (at != end) {
      allowed += kReplacementCharacter;
      ++at;
    }
  }
  return allowed;
}

std::string printable(std::string_view text) { return allowed_text(text, leaves_a_terminal_alone, " "); }

}  // namespace dts::core
