// SPDX-License-Identifier: Apache-2.0
#include "visits/retest.h"

#include <cmath>

namespace dts::visits {
namespace {

/// Standard error of measurement 15.9 to 23.6 % over stances and eyes; the larger one, times 1.96 times the square root of 2.
constexpr Retest kVelocityMl{
    .percent = 65.0,
    .source =
        "Riemann & Piersol 2016, doi:10.1007/s40520-016-0687-2: 30 people above 65 years, 45 s, eyes open and closed, two days; "
        "standard error of measurement at most 23.6 % of the mean, so 95 % of differences are below 65 % of it"};

}  // namespace

bool Retest::is_within(double one, double other) const noexcept { return std::abs(other - one) <= percent / 100.0 * (one + other) / 2.0; }

const Retest* retest_of(const Series& series) noexcept {
  constexpr double kStudiedS = 45.0;
  constexpr double kToleranceS = 15.0;
  if (series.points.empty() || !series.points.back().duration_s) return nullptr;
  if (std::abs(*series.points.back().duration_s - kStudiedS) > kToleranceS) return nullptr;
  const bool is_same_task = series.condition == "eyes-open" || series.condition == "eyes-closed";
  return is_same_task && series.measure == "MVELO_ML" ? &kVelocityMl : nullptr;
}

}  // namespace dts::visits
