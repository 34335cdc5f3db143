// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

namespace dts::cli {

/// Checks of option values. CLI11's own let "nan" through and say ranges in a style of their own.

/// A finite number; `unit` names what is counted: "seconds".
[[nodiscard]] CLI::Validator number_between(double minimum, double maximum, const std::string& unit);
[[nodiscard]] CLI::Validator whole_number_between(std::int64_t minimum, std::int64_t maximum);
[[nodiscard]] CLI::Validator count_from_one();
/// A text of so many bytes.
[[nodiscard]] CLI::Validator text_of(std::size_t minimum, std::size_t maximum);

}  // namespace dts::cli
