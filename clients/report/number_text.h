// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::report {

/// Formats a number with this many decimals, a decimal point, and no sign for zero: the same bytes for every locale. Not finite: "-".
[[nodiscard]] std::string fixed(double value, int decimals);
/// Formats at least four significant digits, as in tables: "304.6", "0.2290", "8.070", "12346", "1.234e-05".
[[nodiscard]] std::string significant(double value);
/// "07", "12", "123".
[[nodiscard]] std::string two_digits(std::uint64_t number);
/// "2026-11-21 14:45:25 UTC".
[[nodiscard]] std::string utc_text(std::int64_t utc_ns);

}  // namespace dts::report
