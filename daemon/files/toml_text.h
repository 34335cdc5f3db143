// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace dts::files {

/// The shortest TOML float that reads back as the same double; `value` is finite.
[[nodiscard]] std::string toml_number(double value);
/// "[1.0, 2.0]"
[[nodiscard]] std::string toml_numbers(std::span<const double> values);
/// In quotes, with whatever needs it escaped.
[[nodiscard]] std::string toml_quoted(std::string_view text);

}  // namespace dts::files
