// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace dts::report {

/// The language of pages.
enum class Language : std::uint8_t { English, German };

/// Returns "en" or "de".
[[nodiscard]] constexpr std::string_view code(Language language) noexcept { return language == Language::German ? "de" : "en"; }

/// Returns the language of a code; nothing for another code.
[[nodiscard]] constexpr std::optional<Language> language_of(std::string_view text) noexcept {
  if (text == "en") return Language::English;
  if (text == "de") return Language::German;
  return std::nullopt;
}

}  // namespace dts::report
