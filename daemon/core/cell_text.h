// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dts::core {

/// Returns the text with an apostrophe before it if it starts with one of = + - @, tab or carriage return and is not a number: a
/// spreadsheet would compute it as a formula (OWASP, "CSV Injection").
[[nodiscard]] std::string as_cell(std::string_view text);

/// Returns `as_cell` of the text as a field of a CSV file (RFC 4180), in quotes if necessary.
[[nodiscard]] std::string csv_cell(std::string_view text);

/// Returns the text without the apostrophe of `as_cell`.
[[nodiscard]] std::string_view text_of_cell(std::string_view cell) noexcept;

}  // namespace dts::core
