// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "posturography/time_domain.h"

namespace dts::posturography {
namespace {

std::size_t whole_at_least_1(double value) noexcept { return value < 1.5 ? 1U : static_cast<std::size_t>(std::llround(value)); }

double speed_at(std::span<const double> values, std::size_t i, double rate_hz) noexcept {
  return std::abs(values[i + 1] - values[i]) * rate_hz;
}

double largest_speed(std::span<const double> values, std::size_t begin, std::size_t end, double rate_hz) noexcept {
  double largest = 0.0;
  for (std::size_t i = begin; i < end; ++i) largest = std::max(largest, speed_at(values, i, rate_hz));
  return largest;
}

/// Adds the average over complete windows of the largest speed within each; nothing if no window is complete.
void add_average_largest_speed(Measure measure, std::span<const double> values, double rate_hz, double window_s, Measures& measures) {
  const std::size_t length = whole_at_least_1(window_s * rate_hz);
  const std::size_t windows = (values.size() - 1) / length;
  if (windows == 0) return;
  double sum = 0.0;
  for (std::size_t i = 0; i < windows; ++i) sum += largest_speed(values, i * length, (i + 1) * length, rate_hz);
  measures.set(measure, sum / static_cast<double>(windows));
}

void add_speeds(const Prepared& cop, Measures& measures) {
  measures.set(Measure::VmaxAp, largest_speed(cop.ap_mm, 0, cop.size() - 1, cop.rate_hz));
  measures.set(Measure::VmaxMl, largest_speed(cop.ml_mm, 0, cop.size() - 1, cop.rate_hz));
  const auto add = [&](Measure ap, Measure ml, double window_s) {
    add_average_largest_speed(ap, cop.ap_mm, cop.rate_hz, window_s, measures);
    add_average_largest_speed(ml, cop.ml_mm, cop.rate_hz, window_s, measures);
  };
  add(Measure::Aamv1sAp, Measure::Aamv1sMl, 1.0);
  add(Measure::Aamv2sAp, Measure::Aamv2sMl, 2.0);
  add(Measure::Aamv5sAp, Measure::Aamv5sMl, 5.0);
}

/// Returns the directions of the steps between every `step`-th sample; skips steps of length 0, which have no direction.
std::vector<double> headings_deg(const Prepared& cop, std::size_t step) {
  std::vector<double> headings;
  for (std::size_t i = 0; i + step < cop.size(); i += step) {
    const double ap = cop.ap_mm[i + step] - cop.ap_mm[i];
    const double ml = cop.ml_mm[i + step] - cop.ml_mm[i];
    if (ap != 0.0 || ml != 0.0) headings.push_back(std::atan2(ap, ml) * 180.0 / std::numbers::pi);
  }
  return headings;
}

/// Wraps an angle to (-180, 180].
double wrapped_deg(double angle_deg) noexcept {
  const double wrapped = std::remainder(angle_deg, 360.0);
  return wrapped <= -180.0 ? 180.0 : wrapped;
}

/// Rhea et al. 2014. Only for filtered data, because quantisation noise always has a heading change of about 110 degrees.
void add_heading_change(const Prepared& cop, Measures& measures) {
  const std::size_t step = whole_at_least_1(cop.rate_hz / kHeadingRateHz);
  std::vector<double> changes = headings_deg(cop, step);
  if (changes.size() < 2) return;
  for (std::size_t i = 0; i + 1 < changes.size(); ++i) changes[i] = wrapped_deg(changes[i + 1] - changes[i]);
  changes.pop_back();

  const auto count = static_cast<double>(changes.size());
  double sum = 0.0;
  double magnitudes = 0.0;
  for (const double change : changes) {
    sum += change;
    magnitudes += std::abs(change);
  }
  const double mean = sum / count;
  double squares = 0.0;
  for (const double change : changes) squares += (change - mean) * (change - mean);
  measures.set(Measure::HcMeanabs, magnitudes / count);
  measures.set(Measure::HcSd, std::sqrt(squares / count));
  measures.set(Measure::HcRate, magnitudes / count * cop.rate_hz / static_cast<double>(step));
}

}  // namespace

void add_velocity_and_direction(const Prepared& prepared, std::optional<double> foot_length_mm, Measures& measures) {
  if (prepared.size() < 2 || prepared.ap_mm.size() != prepared.size() || !(prepared.rate_hz > 0.0)) return;
  add_speeds(prepared, measures);
  if (prepared.profile == Profile::Lp10) add_heading_change(prepared, measures);
  if (foot_length_mm && *foot_length_mm > 0.0) {
    const auto [least, most] = std::minmax_element(prepared.ap_mm.begin(), prepared.ap_mm.end());
    measures.set(Measure::ApUse, 100.0 * (*most - *least) / *foot_length_mm);
  }
}

}  // namespace dts::posturography
