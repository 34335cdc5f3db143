// SPDX-License-Identifier: Apache-2.0
#include "posturography/analysis.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "posturography/diffusion.h"
#include "posturography/entropy.h"
#include "posturography/spectrum.h"
#include "posturography/time_domain.h"

namespace dts::posturography {
namespace {

constexpr double kLeastS = 10.0;
constexpr std::size_t kLeastSamples = 200;
constexpr double kLeastForQuantilesS = 20.0;
constexpr double kLeastForDiffusionS = 30.0;
/// A rate of 1500.0375 Hz turns 30 s of clock time into 29.9993 s.
constexpr double kDurationSlack = 1e-4;
constexpr double kEntropyRateHz = 20.0;
constexpr std::size_t kMostForEntropy = 72'000;  // one hour at 20 Hz: a few seconds of computing
constexpr double kRateSlack = 1e-3;

bool lasts(const Prepared& prepared, double least_s) noexcept { return prepared.duration_s() >= least_s * (1.0 - kDurationSlack); }

bool is_whole_part(double rate_hz, double of_rate_hz) noexcept {
  const double parts = of_rate_hz / rate_hz;
  return parts > 0.5 && std::abs(parts - std::round(parts)) <= kRateSlack * parts;
}

/// `prepare` always returns sound data; one NaN would affect every measure.
bool is_sound(const Prepared& prepared) noexcept {
  const auto is_finite = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  };
  return prepared.size() > 0 && prepared.ap_mm.size() == prepared.size() && prepared.rate_hz > 0.0 && std::isfinite(prepared.rate_hz) &&
         is_finite(prepared.ml_mm) && is_finite(prepared.ap_mm);
}

bool moves(std::span<const double> values) noexcept {
  return std::any_of(values.begin(), values.end(), [first = values.front()](double value) { return value != first; });
}

std::uint32_t flags_of(const Prepared& prepared) {
  std::uint32_t flags = prepared.flags;
  if (!lasts(prepared, kLeastS) || prepared.size() < kLeastSamples) flags |= sway_flag::kShortRecord;
  if (!lasts(prepared, kLeastForQuantilesS)) flags |= sway_flag::kShortForQuantiles;
  if (!lasts(prepared, kLeastForDiffusionS)) flags |= sway_flag::kShortForDiffusion;
  const bool moves_ml = moves(prepared.ml_mm);
  const bool moves_ap = moves(prepared.ap_mm);
  if (!moves_ml && !moves_ap) flags |= sway_flag::kConstant;
  if (moves_ml != moves_ap) flags |= sway_flag::kConstantAxis;
  const bool is_on_rates = is_whole_part(kEntropyRateHz, prepared.rate_hz) && is_whole_part(kHeadingRateHz, prepared.rate_hz);
  if (prepared.profile == Profile::Lp10 && !is_on_rates) flags |= sway_flag::kOffRates;
  return flags;
}

/// The two lines of the diffusion plot always cross somewhere; the crossing is a critical point only if the slopes differ (section 5).
bool has_unclear_critical_point(const Measures& measures) {
  for (const Axis axis : {Axis::Planar, Axis::Ap, Axis::Ml}) {
    const auto brief = measures.get(of(Measure::SdaDsRes, axis));
    const auto lasting = measures.get(of(Measure::SdaDlRes, axis));
    if (measures.has(of(Measure::SdaTcRes, axis)) && brief && lasting && !(*brief > 2.0 * *lasting)) return true;
  }
  return false;
}

/// Only for filtered data, because sensor noise is maximally irregular.
void add_entropy(const Prepared& prepared, Analysis& analysis) {
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(prepared.rate_hz / kEntropyRateHz)));
  const std::size_t count = (prepared.size() + step - 1) / step;
  if (count > kMostForEntropy) analysis.flags |= sway_flag::kLongForEntropy;
  if (count < kLeastSamples || count > kMostForEntropy) return;
  const auto add = [&](Measure measure, const std::vector<double>& values) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < values.size(); i += step) kept.push_back(values[i]);
    if (const auto entropy = sample_entropy(kept)) analysis.measures.set(measure, *entropy);
  };
  add(Measure::SampenAp, prepared.ap_mm);
  add(Measure::SampenMl, prepared.ml_mm);
}

}  // namespace

Analysis analyse(const Prepared& prepared, std::optional<double> foot_length_mm) {
  Analysis analysis;
  analysis.profile = prepared.profile;
  analysis.rate_hz = prepared.rate_hz;
  analysis.samples = prepared.size();
  analysis.flags = prepared.flags;
  analysis.missing = prepared.missing;
  analysis.interpolated = prepared.interpolated;
  if (!is_sound(prepared)) return analysis;
  analysis.duration_s = prepared.duration_s();
  analysis.flags = flags_of(prepared);
  const auto has = [&](std::uint32_t flag) { return (analysis.flags & flag) != 0; };

  add_time_domain(prepared, analysis.measures);
  add_velocity_and_direction(prepared, foot_length_mm, analysis.measures);
  if (has(sway_flag::kShortRecord)) return analysis;
  add_frequency_domain(prepared, multitaper_spectra(prepared), !has(sway_flag::kShortForQuantiles), analysis.measures);
  add_random_walk(prepared, mean_square_displacement(prepared), !has(sway_flag::kShortForDiffusion), analysis.measures);
  if (has_unclear_critical_point(analysis.measures)) analysis.flags |= sway_flag::kUnclearCriticalPoint;
  if (prepared.profile == Profile::Lp10) add_entropy(prepared, analysis);
  return analysis;
}

core::Result<Analysis> analyse(const CopSeries& series, const AnalysisOptions& options) {
  DTS_TRY_ASSIGN(const auto prepared, prepare(series, options.preparation));
  return analyse(prepared, options.foot_length_mm);
}

}  // namespace dts::posturography
