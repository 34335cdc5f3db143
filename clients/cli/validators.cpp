// SPDX-License-Identifier: Apache-2.0
#include "cli/validators.h"

#include <CLI/StringTools.hpp>
#include <charconv>

namespace dts::cli {
namespace {

/// Parses the whole `text` as a value; returns false for anything else.
template <class Value>
bool read(const std::string& text, Value& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

CLI::Validator number_between(double minimum, double maximum, const std::string& unit) {
  const auto check = [=](std::string& text) -> std::string {
    double value = 0.0;
    if (read(text, value) && value >= minimum && value <= maximum) return {};
    return "'" + text + "' is not a number of " + unit + " from " + CLI::detail::to_string(minimum) + " to " +
           CLI::detail::to_string(maximum);
  };
  return {check, "", "number"};
}

CLI::Validator whole_number_between(std::int64_t minimum, std::int64_t maximum) {
  const auto check = [=](std::string& text) -> std::string {
    std::int64_t value = 0;
    if (read(text, value) && value >= minimum && value <= maximum) return {};
    return "'" + text + "' is not a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum);
  };
  return {check, "", "whole number"};
}

CLI::Validator count_from_one() {
  const auto check = [](std::string& text) -> std::string {
    std::uint64_t value = 0;
    if (read(text, value) && value > 0) return {};
    return "'" + text + "' is not a whole number of at least 1";
  };
  return {check, "", "count"};
}

CLI::Validator text_of(std::size_t minimum, std::size_t maximum) {
  const auto check = [=](std::string& text) -> std::string {
    if (text.size() >= minimum && text.size() <= maximum) return {};
    return "the text must have " + std::to_string(minimum) + " to " + std::to_string(maximum) + " bytes";
  };
  return {check, "", "text"};
}

}  // namespace dts::cli
