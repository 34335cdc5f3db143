// SPDX-License-Identifier: Apache-2.0
// What must hold for every rate and every index. A failure prints the smallest counter-example and how to repeat it.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "core/rate.h"

namespace dts::core {
namespace {

constexpr std::int64_t kLargestTerm = 100'000'000;  // a 100 MHz clock and its divisors
constexpr std::uint64_t kLargestIndex = 10'000'000'000;

Rate any_rate() {
  const auto scans = *rc::gen::inRange<std::int64_t>(1, kLargestTerm);
  const auto seconds = *rc::gen::inRange<std::int64_t>(1, kLargestTerm);
  return Rate::create(scans, seconds).value();
}

ScanIndex any_index(std::uint64_t largest) { return {*rc::gen::inRange<std::uint64_t>(0, largest)}; }

/// Largest index whose time is well below the end of the range for every rate that any_rate() can make.
std::uint64_t reachable(const Rate& rate) {
  constexpr double kLatest_s = 9e9;
  return static_cast<std::uint64_t>(std::max(2.0, std::min(static_cast<double>(kLargestIndex), kLatest_s * rate.hz())));
}

RC_GTEST_PROP(RateProperty, TimeOfAnyIndex_IsTheExactFractionRoundedToNearest, ()) {
  const Rate rate = any_rate();
  const ScanIndex index = any_index(reachable(rate));

  const std::int64_t time_ns = rate.time_ns(index);

  // |time - index * seconds / scans * 1e9| <= 1/2, multiplied out so that everything is a whole number.
  __extension__ using Wide = __int128;
  const Wide exact_times_scans = Wide{index.value} * rate.denominator() * 1'000'000'000;
  const Wide error_times_scans = Wide{time_ns} * rate.numerator() - exact_times_scans;
  const Wide magnitude = error_times_scans < 0 ? -error_times_scans : error_times_scans;
  RC_ASSERT(2 * magnitude <= Wide{rate.numerator()});
}

RC_GTEST_PROP(RateProperty, TimeOfLaterIndex_IsNotEarlier, ()) {
  const Rate rate = any_rate();
  const ScanIndex index{*rc::gen::arbitrary<std::uint64_t>() / 2};
  const auto step = *rc::gen::inRange<std::uint64_t>(0, 1'000'000);

  RC_ASSERT(rate.time_ns(index + step) >= rate.time_ns(index));
}

RC_GTEST_PROP(RateProperty, WholeRounds_TakeWholeSeconds, ()) {
  const Rate rate = any_rate();
  const auto rounds = *rc::gen::inRange<std::uint64_t>(0, 90);

  const std::int64_t time_ns = rate.time_ns({rounds * static_cast<std::uint64_t>(rate.numerator())});

  RC_ASSERT(time_ns == static_cast<std::int64_t>(rounds) * rate.denominator() * 1'000'000'000);
}

RC_GTEST_PROP(RateProperty, DividedRate_HasEveryNthTime, ()) {
  const Rate rate = any_rate();
  const auto factor = *rc::gen::inRange<std::int64_t>(1, 1000);
  const ScanIndex index = any_index(std::max<std::uint64_t>(2, reachable(rate) / 1000));

  const Rate divided = rate.divided_by(factor);

  RC_ASSERT(divided.time_ns(index) == rate.time_ns({index.value * static_cast<std::uint64_t>(factor)}));
}

RC_GTEST_PROP(RateProperty, FromHz_IsWithinHalfAMicrohertz, ()) {
  const auto microhertz = *rc::gen::inRange<std::int64_t>(1, 1'000'000'000'000);

  const Rate rate = Rate::from_hz(static_cast<double>(microhertz) * 1e-6).value();

  RC_ASSERT(rate == Rate::create(microhertz, 1'000'000).value());
}

}  // namespace
}  // namespace dts::core
