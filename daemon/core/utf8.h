// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dts::core {

/// Replaces bytes that are not valid UTF-8: U+FFFD.
inline constexpr std::string_view kReplacementCharacter = "\xEF\xBF\xBD";

/// Returns false for the second and further bytes of a character. Never cut a text before such a byte.
[[nodiscard]] constexpr bool starts_character(char byte) noexcept { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }

/// Returns the number of characters of valid UTF-8.
[[nodiscard]] std::size_t character_count(std::string_view text) noexcept;

/// Overlong forms, surrogates and codes above U+10FFFF are not valid.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// Returns the characters of valid UTF-8.
[[nodiscard]] std::u32string characters_of(std::string_view text);

/// Returns the text with `instead` for each character that `is_allowed` rejects, and U+FFFD for each byte that is not valid UTF-8.
[[nodiscard]] std::string allowed_text(std::string_view text, bool (*is_allowed)(std::uint32_t code), std::string_view instead);

/// Returns the text as one line that cannot control a terminal; for texts from peers and files. A control character (C0, DEL, C1) or a
/// character that changes the direction of the text (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069) becomes a space; a byte
/// that is not valid UTF-8 becomes U+FFFD.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace dts::core
