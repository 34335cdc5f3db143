// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dts::cli {

/// The candidate that `word` was probably meant to be; empty when none is near enough (a third of its letters, at least
/// one, may be wrong, missing, added or swapped).
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace dts::cli
