// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::core {

// Letters and spaces of every script (Unicode 14.0), whatever the locale of the process is.

/// Returns whether this is a capital letter: general category Lu.
[[nodiscard]] bool is_capital_letter(char32_t character) noexcept;
/// Returns whether this is a space or a separator of lines: general category Z.
[[nodiscard]] bool is_space(char32_t character) noexcept;

}  // namespace dts::core
