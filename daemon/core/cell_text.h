// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dts::core {

/// Puts an apostrophe in front of a text that starts with one of = + - @, tab or carriage return and is no number: a spreadsheet would
/// compute it (OWASP, "CSV Injection").
[[nodiscard]] std::string as_cell(std::string_view text);

/// Returns the text of a cell of a CSV file (RFC 4180): `as_cell`, in quotes when it must be.
[[nodiscard]] std::string csv_cell(std::string_view text);

/// Takes the apostrophe of `as_cell` away again.
[[nodiscard]] std::string_view text_of_cell(std::string_view cell) noexcept;

}  // namespace dts::core
