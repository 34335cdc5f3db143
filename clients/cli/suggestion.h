// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/suggest.h"

namespace dts::cli {

/// Calls `core::suggest` for folders that must not include core: returns the candidate most similar to `word`, or an empty text.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

using core::known_words_hint;

}  // namespace dts::cli
