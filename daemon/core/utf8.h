// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dts::core {

/// Replaces bytes that are not valid UTF-8: U+FFFD.
inline constexpr std::string_view kReplacementCharacter = "\xEF\xBF\xBD";

struct Utf8Character {
  std::size_t length = 0;  ///< Number of bytes; 0: the text does not start with a valid character.
  std::uint32_t code = 0;
};

/// Returns the first character of `text`, which must not be empty. Overlong forms, surrogates and codes above U+10FFFF are not valid.
[[nodiscard]] Utf8Character first_character(std::string_view text) noexcept;

/// Returns the text as one line that cannot control a terminal; for texts from peers and files. A control character (C0, DEL, C1) or a
/// character that changes the direction of the text (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069) becomes a space; a byte
/// that is not valid UTF-8 becomes U+FFFD.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace dts::core
