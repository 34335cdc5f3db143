// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace dts::core {

/// The word of `known` that `word` was probably meant to be, for "did you mean ...?"; empty when none is near. Counts
/// inserted, deleted, replaced and swapped neighbouring characters, and allows one per three characters of `word`.
/// Upper and lower case count as equal. Thread: any. Realtime-safe: no.
[[nodiscard]] std::string suggest(std::string_view word, std::span<const std::string_view> known);

}  // namespace dts::core
