// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/rig_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "posturography/spectrum.h"

namespace dts::lab::steadiness {
namespace {

using posturography::Measure;
using posturography::Measures;

constexpr std::array kKnown{Measure::Mdist,   Measure::Rdist,   Measure::RdistAp, Measure::RdistMl, Measure::Mvelo,
                            Measure::MveloAp, Measure::MveloMl, Measure::RangeAp, Measure::RangeMl, Measure::Pea95F,
                            Measure::AreaSw,  Measure::Mfreq,   Measure::CfreqAp};
constexpr double kFilterHz = 10.0;
/// The highest of the few independent samples near an extreme of the sway is so many SD of the noise above it.
constexpr double kExtremeSd = 1.2;

/// Returns the power response of the filter of `lp10`: of 4th order, forward and backward, by the bilinear transform at `scan_hz`.
double power_response(double frequency_hz, double scan_hz) {
  const double ratio = std::tan(std::numbers::pi * frequency_hz / scan_hz) / std::tan(std::numbers::pi * kFilterHz / scan_hz);
  const double once = 1.0 / (1.0 + std::pow(ratio, 8.0));
  return once * once;
}

/// Returns the root of the sum of a square and a variance.
double widened(double value, double variance) { return std::sqrt(value * value + variance); }

}  // namespace

RigNoise::RigNoise(double noise_mm, double scan_hz, double rate_hz, posturography::Profile profile) noexcept
    : density_(2.0 * noise_mm * noise_mm / scan_hz) {
  constexpr int kSteps = 4000;
  const bool is_filtered = profile == posturography::Profile::Lp10 && scan_hz > 2.0 * kFilterHz;
  const double step_hz = 0.5 * scan_hz / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const double frequency_hz = (k + 0.5) * step_hz;
    const double energy = density_ * step_hz * (is_filtered ? power_response(frequency_hz, scan_hz) : 1.0);
    const double difference = 2.0 * rate_hz * std::sin(std::numbers::pi * frequency_hz / rate_hz);
    variance_mm2_ += energy;
    velocity_variance_ += energy * difference * difference;
  }
}

bool RigNoise::is_known_for(Measure measure) noexcept { return std::ranges::find(kKnown, measure) != kKnown.end(); }

Measures RigNoise::added_to(const Measures& measures) const noexcept {
  constexpr double kPi = std::numbers::pi;
  Measures noisy;
  const auto set = [&](Measure measure, auto formula) {
    if (const auto value = measures.get(measure)) noisy.set(measure, formula(*value));
  };
  const auto factor = [&](Measure measure) {
    const auto before = measures.get(measure);
    const auto after = noisy.get(measure);
    return before && after && *before > 0.0 ? *after / *before : 1.0;
  };
  const double sd_mm = std::sqrt(variance_mm2_);
  set(Measure::Rdist, [&](double value) { return widened(value, 2.0 * variance_mm2_); });
  for (const Measure axis : {Measure::RdistAp, Measure::RdistMl}) set(axis, [&](double value) { return widened(value, variance_mm2_); });
  for (const Measure axis : {Measure::RangeAp, Measure::RangeMl}) set(axis, [&](double value) { return value + 2.0 * kExtremeSd * sd_mm; });
  // The mean of the absolute velocity of one axis is sqrt(2 / pi) of its SD, that of the planar speed sqrt(pi / 2) of the SD of an axis.
  set(Measure::Mvelo, [&](double value) { return widened(value, 0.5 * kPi * velocity_variance_); });
  for (const Measure axis : {Measure::MveloAp, Measure::MveloMl})
    set(axis, [&](double value) { return widened(value, 2.0 / kPi * velocity_variance_); });
  set(Measure::Mdist, [&](double value) { return value * factor(Measure::Rdist); });
  set(Measure::Pea95F, [&](double value) { return value * factor(Measure::RdistAp) * factor(Measure::RdistMl); });
  set(Measure::AreaSw, [&](double value) { return value * factor(Measure::Mvelo) * factor(Measure::Mdist); });
  set(Measure::Mfreq, [&](double value) { return value * factor(Measure::Mvelo) / factor(Measure::Mdist); });
  if (const auto power = measures.get(Measure::PowerAp); power && *power > 0.0) {
    constexpr double kLow = posturography::kBandLowHz;
    constexpr double kHigh = posturography::kBandHighHz;
    const double more_power = density_ * (kHigh - kLow);
    const double more_moment = density_ * (kHigh * kHigh * kHigh - kLow * kLow * kLow) / 3.0;
    set(Measure::CfreqAp, [&](double value) { return std::sqrt((value * value * *power + more_moment) / (*power + more_power)); });
  }
  return noisy;
}

}  // namespace dts::lab::steadiness
