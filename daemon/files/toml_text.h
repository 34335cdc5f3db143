// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace dts::files {

/// Returns the shortest TOML float that reads back as the same double; `value` must be finite.
[[nodiscard]] std::string toml_number(double value);
/// Returns a list such as "[1.0, 2.0]".
[[nodiscard]] std::string toml_numbers(std::span<const double> values);
/// Returns the text in quotes, with special characters escaped.
[[nodiscard]] std::string toml_quoted(std::string_view text);

}  // namespace dts::files
