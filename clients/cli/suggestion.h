// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dts::cli {

/// `core::suggest` for rooms that do not include core: the candidate that `word` was probably meant to be, or nothing.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace dts::cli
