// SPDX-License-Identifier: Apache-2.0
#include "core/utc_text.h"

#include <algorithm>
#include <chrono>

namespace dts::core {

std::string utc_text(std::int64_t utc_ns) {
  namespace time = std::chrono;
  const time::sys_time<time::microseconds> instant{time::microseconds(utc_ns / 1000)};
  const auto day = time::floor<time::days>(instant);
  const time::year_month_day date(day);
  const time::hh_mm_ss clock(instant - day);
  const auto padded = [](auto number, std::size_t digits) {
    const std::string text = std::to_string(number);
    return std::string(digits - std::min(digits, text.size()), '0') + text;
  };
  return padded(static_cast<int>(date.year()), 4) + "-" + padded(static_cast<unsigned>(date.month()), 2) + "-" +
         padded(static_cast<unsigned>(date.day()), 2) + "T" + padded(clock.hours().count(), 2) + ":" + padded(clock.minutes().count(), 2) +
         ":" + padded(clock.seconds().count(), 2) + "." + padded(clock.subseconds().count(), 6) + "Z";
}

}  // namespace dts::core
