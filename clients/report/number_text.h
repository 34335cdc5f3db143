// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::report {

/// A number with so many decimals, a point, and no sign in front of zero: the same bytes whatever the locale. Not finite: "-".
[[nodiscard]] std::string fixed(double value, int decimals);
/// Four significant digits, as tables show values: "304.6", "0.2290", "8.070", "12346", "1.234e-05".
[[nodiscard]] std::string significant(double value);
/// "07", "12", "123".
[[nodiscard]] std::string two_digits(std::uint64_t number);
/// "2026-11-21 14:45:25 UTC".
[[nodiscard]] std::string utc_text(std::int64_t utc_ns);

}  // namespace dts::report
