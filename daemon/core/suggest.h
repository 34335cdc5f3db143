// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dts::core {

/// Returns the word of `known` that is most similar to `word`, for "did you mean ...?"; empty if no word is similar. Counts
/// inserted, deleted and replaced characters and swapped neighbours; allows one per three characters of `word`, and at least one.
/// Ignores case. Thread: any. Realtime-safe: no.
[[nodiscard]] std::string suggest(std::string_view word, std::span<const std::string_view> known);

/// Returns the hint for an unknown word: "did you mean 'x'?" if a known word is similar, else "known: " with all known words.
[[nodiscard]] std::string known_words_hint(std::string_view word, std::span<const std::string_view> known);
[[nodiscard]] std::string known_words_hint(std::string_view word, const std::vector<std::string>& known);

}  // namespace dts::core
