// SPDX-License-Identifier: Apache-2.0
#include "report/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <system_error>

namespace dts::report {
namespace {

constexpr int kDigits = 4;

std::string written(double value, std::chars_format format, int precision) {
  std::array<char, 400> text{};  // the largest double has 309 digits before the decimal point
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, format, precision);
  return error == std::errc() ? std::string(text.data(), end) : "-";
}

}  // namespace

std::string two_digits(std::uint64_t number) { return (number < 10 ? "0" : "") + std::to_string(number); }

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::string text = written(value, std::chars_format::fixed, decimals);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string significant(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0) return "0";
  const std::string scientific = written(value, std::chars_format::scientific, kDigits - 1);  // rounds first, because rounding can change
                                                                                              // the exponent: 9.9996 becomes 1.000e+01
  int exponent = 0;
  const std::size_t mark = scientific.find('e');
  const char* const begin = scientific.data() + mark + (scientific[mark + 1] == '+' ? 2 : 1);
  std::from_chars(begin, scientific.data() + scientific.size(), exponent);
  if (exponent < -4 || exponent > 8) return scientific;
  return fixed(value, std::max(0, kDigits - 1 - exponent));
}

std::string utc_text(std::int64_t utc_ns) {
  using namespace std::chrono;
  const sys_time<nanoseconds> time{nanoseconds(utc_ns)};
  const sys_days day = floor<days>(time);
  const year_month_day date{day};
  const hh_mm_ss clock{floor<seconds>(time - day)};
  return std::to_string(static_cast<int>(date.year())) + "-" + two_digits(static_cast<unsigned>(date.month())) + "-" +
         two_digits(static_cast<unsigned>(date.day())) + " " + two_digits(clock.hours().count()) + ":" +
         two_digits(clock.minutes().count()) + ":" + two_digits(clock.seconds().count()) + " UTC";
}

}  // namespace dts::report
