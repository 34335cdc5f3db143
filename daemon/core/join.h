// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <ranges>
#include <string>
#include <string_view>

namespace dts::core {

/// Returns the items with the separator between them. `projection` makes the text of an item, as in std::ranges algorithms.
template <std::ranges::input_range Items, class Projection = std::identity>
[[nodiscard]] std::string join(const Items& items, std::string_view separator = ", ", Projection projection = {}) {
  std::string text;
  std::string_view before;
  for (const auto& item : items) {
    text += before;
    text += std::invoke(projection, item);
    before = separator;
  }
  return text;
}

}  // namespace dts::core
