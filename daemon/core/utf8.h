// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dts::core {

/// What stands in place of bytes that are no text: U+FFFD.
inline constexpr std::string_view kReplacementCharacter = "\xEF\xBF\xBD";

struct Utf8Character {
  std::size_t length = 0;  ///< Bytes; 0: the text does not start with a character.
  std::uint32_t code = 0;
};

/// The character that `text`, which is not empty, starts with. Overlong forms, surrogates and codes above U+10FFFF are none.
[[nodiscard]] Utf8Character first_character(std::string_view text) noexcept;

/// The text as one line that cannot drive a terminal. Texts come from peers and files. A control character (C0, DEL, C1) or one that
/// changes the direction of the text (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069) becomes a space, a byte that is no UTF-8
/// becomes U+FFFD.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace dts::core
