// SPDX-License-Identifier: Apache-2.0
#include "posturography/prepare.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "posturography/butterworth.h"
#include "posturography/clean_stretch.h"
#include "posturography/trial_faults.h"

namespace dts::posturography {
namespace {

using core::ErrorCode;

constexpr double kLowestRateHz = 10.0;
constexpr double kHighestRateHz = 100'000.0;
constexpr double kLp10CutoffHz = 10.0;
constexpr double kManyLost = 0.01;
constexpr double kLowRateHz = 50.0;  // Scoppa et al. 2013

std::string hz(double rate) { return std::to_string(rate) + " Hz"; }

core::Status check(const CopSeries& series, const Preparation& preparation) {
  const auto invalid = [](std::string what, std::string hint = {}) {
    return core::fail(ErrorCode::InvalidArgument, std::move(what), std::move(hint));
  };
  if (series.ml_mm.size() != series.ap_mm.size() || (!series.load_n.empty() && series.load_n.size() != series.ml_mm.size())) {
    return invalid("the columns of the centre of pressure are not equally long");
  }
  if (!(series.rate_hz >= kLowestRateHz && series.rate_hz <= kHighestRateHz)) {
    return invalid("a centre of pressure sampled at " + hz(series.rate_hz), "rates of 10 to 100000 Hz can be analysed");
  }
  if (preparation.profile != Profile::AsIs && preparation.profile != Profile::Lp10) return invalid("unknown profile");
  if (preparation.profile == Profile::Lp10 && !(series.rate_hz > 2.0 * kLp10CutoffHz)) {
    return invalid("profile lp10 cannot filter " + hz(series.rate_hz) + " at 10 Hz", "use the profile asis");
  }
  if (!(preparation.analysis_rate_hz >= 0.0) || !std::isfinite(preparation.analysis_rate_hz))
    return invalid("the rate of the analysis is not valid");
  if (!(preparation.trim_s >= 0.0) || !std::isfinite(preparation.trim_s)) return invalid("the settling time is not valid");
  return {};
}

void keep_every(std::size_t step, std::size_t first, std::vector<double>& values) {
  std::size_t kept = 0;
  for (std::size_t i = first; i < values.size(); i += step) values[kept++] = values[i];
  values.resize(kept);
}

/// Subtracts the mean and returns it.
double centre(std::vector<double>& values) noexcept {
  double sum = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  return mean;
}

core::Status too_little(std::size_t samples, std::size_t needed, double rate_hz) {
  if (samples == 0)
    return core::fail(ErrorCode::Failed, "there is no sample of the centre of pressure",
                      "check that a person stood on the plate and that samples were recorded");
  return core::fail(ErrorCode::Failed,
                    "only " + std::to_string(samples) + " samples (" + std::to_string(static_cast<double>(samples) / rate_hz) +
                        " s) are left of the centre of pressure, and " + std::to_string(needed) + " are needed",
                    "record for longer, or shorten the settling time");
}

std::size_t decimation(const Preparation& preparation, double rate_hz) noexcept {
  if (preparation.profile != Profile::Lp10 || preparation.analysis_rate_hz <= 0.0) return 1;
  const double factor = std::round(rate_hz / preparation.analysis_rate_hz);
  return factor < 1.0 ? 1 : static_cast<std::size_t>(std::min(factor, kHighestRateHz));
}

/// Settling starts with the first sample that is present; after a gap the person already stands on the plate.
std::size_t samples_to_trim(const CopSeries& series, const CleanStretches& clean, const Preparation& preparation, double rate_hz) {
  const double stood_s = static_cast<double>(clean.longest().begin - clean.all.front().begin) / series.rate_hz;
  const double trimmed = std::ceil((preparation.trim_s - stood_s - kTimeSlackS) * rate_hz);
  return trimmed <= 0.0 ? 0 : static_cast<std::size_t>(std::min(trimmed, 1e15));
}

std::uint32_t flags_of(const CopSeries& series, const CleanStretches& clean, const Preparation& preparation) {
  std::uint32_t flags = series.flags;
  if (static_cast<double>(clean.missing) > kManyLost * static_cast<double>(series.ml_mm.size())) flags |= sway_flag::kMissingSamples;
  if (clean.is_cut(series)) flags |= sway_flag::kCutAtGap;
  if (series.rate_hz < kLowRateHz) flags |= sway_flag::kLowRate;
  const auto settled = static_cast<double>(clean.all.front().begin) + preparation.trim_s * series.rate_hz;
  if (settled < static_cast<double>(series.load_n.size()) && load_goes_away(series, static_cast<std::size_t>(settled))) {
    flags |= sway_flag::kSteppedOff;
  }
  return flags;
}

}  // namespace

std::string_view name(Profile profile) noexcept {
  switch (profile) {
    case Profile::AsIs: return "asis";
    case Profile::Lp10: return "lp10";
  }
  return {};
}

std::optional<Profile> profile_named(std::string_view name_of_profile) noexcept {
  for (const Profile profile : {Profile::AsIs, Profile::Lp10}) {
    if (name(profile) == name_of_profile) return profile;
  }
  return std::nullopt;
}

core::Result<Prepared> prepare(const CopSeries& series, const Preparation& preparation) {
  DTS_TRY(check(series, preparation));
  const CleanStretches clean = clean_stretches(series);
  const Stretch longest = clean.longest();
  const bool is_filtered = preparation.profile == Profile::Lp10;
  const std::size_t needed = is_filtered ? kZeroPhasePadding + 1 : 2;
  if (longest.size() < needed) return tl::make_unexpected(too_little(longest.size(), needed, series.rate_hz).error());

  Prepared prepared;
  prepared.profile = preparation.profile;
  prepared.missing = clean.missing;
  prepared.flags = flags_of(series, clean, preparation);
  StretchCopy copy = copy_of(series, longest);
  prepared.ml_mm = std::move(copy.ml_mm);
  prepared.ap_mm = std::move(copy.ap_mm);
  prepared.interpolated = copy.interpolated;
  if (is_filtered) {
    const LowPass low_pass = butterworth4(kLp10CutoffHz, series.rate_hz);
    filter_zero_phase(low_pass, prepared.ml_mm);
    filter_zero_phase(low_pass, prepared.ap_mm);
  }
  const std::size_t step = decimation(preparation, series.rate_hz);
  prepared.rate_hz = series.rate_hz / static_cast<double>(step);
  const std::size_t trimmed = samples_to_trim(series, clean, preparation, prepared.rate_hz);
  const std::size_t kept = (longest.size() + step - 1) / step;
  if (kept < trimmed + 2) return tl::make_unexpected(too_little(kept - std::min(kept, trimmed), 2, prepared.rate_hz).error());
  if (position_jumps(prepared.ml_mm, prepared.ap_mm, trimmed * step, series.rate_hz)) prepared.flags |= sway_flag::kMoved;
  keep_every(step, trimmed * step, prepared.ml_mm);
  keep_every(step, trimmed * step, prepared.ap_mm);
  prepared.begins_s = static_cast<double>(longest.begin + trimmed * step) / series.rate_hz;
  prepared.mean_ml_mm = copy.first_ml_mm + centre(prepared.ml_mm);
  prepared.mean_ap_mm = copy.first_ap_mm + centre(prepared.ap_mm);
  return prepared;
}

}  // namespace dts::posturography
