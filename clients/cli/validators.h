// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

namespace dts::cli {

/// Checks of option values. CLI11's own checks accept "nan" and have other texts for ranges.

/// Accepts a finite number; `unit` names the unit: "seconds".
[[nodiscard]] CLI::Validator number_between(double minimum, double maximum, const std::string& unit);
[[nodiscard]] CLI::Validator whole_number_between(std::int64_t minimum, std::int64_t maximum);
[[nodiscard]] CLI::Validator count_from_one();
/// Accepts a text with this number of bytes.
[[nodiscard]] CLI::Validator text_of(std::size_t minimum, std::size_t maximum);

}  // namespace dts::cli
