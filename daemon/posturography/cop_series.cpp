// SPDX-License-Identifier: Apache-2.0
#include "posturography/cop_series.h"

#include <array>
#include <cstddef>

namespace dts::posturography {
namespace {

struct Flag {
  std::uint32_t bit;
  std::string_view name;
  std::string_view sentence;
};

constexpr std::array kFlags = {
    Flag{sway_flag::kShortRecord, "short_record", "Under 10 s or 200 samples: time-domain values only."},
    Flag{sway_flag::kShortForQuantiles, "short_for_quantiles", "Under 20 s: no median and 95 % frequency."},
    Flag{sway_flag::kShortForDiffusion, "short_for_diffusion", "Under 30 s: no stabilogram diffusion."},
    Flag{sway_flag::kMissingSamples, "missing_samples", "More than 1 % of the samples are missing."},
    Flag{sway_flag::kCutAtGap, "cut_at_gap", "Samples are missing for more than 50 ms: only the longest clean stretch was analysed."},
    Flag{sway_flag::kResampled, "resampled", "The time stamps are uneven: interpolated linearly."},
    Flag{sway_flag::kWindowAveraged, "window_averaged", "The time stamps are very uneven: averaged over sliding windows."},
    Flag{sway_flag::kConstant, "constant", "The centre of pressure does not move at all."},
    Flag{sway_flag::kConstantAxis, "constant_axis", "The centre of pressure moves along one axis only."},
    Flag{sway_flag::kOffRates, "off_rates",
         "Entropy and heading are not at 20 and 25 Hz but at the nearest rates that divide the sampling rate."},
    Flag{sway_flag::kLowRate, "low_rate", "Sampled at less than 50 Hz."},
    Flag{sway_flag::kSteppedOff, "stepped_off", "The load went away: the subject stepped off. Invalid."},
    Flag{sway_flag::kMoved, "moved", "The centre of pressure jumped: the subject moved the feet. Invalid."},
    Flag{sway_flag::kDoubtful, "doubtful", "A sensor or its calibration was in doubt."},
    Flag{sway_flag::kUnclearCriticalPoint, "unclear_critical_point",
         "The critical time of an axis is doubtful: short-term diffusion is not twice the long-term one."},
    Flag{sway_flag::kLongForEntropy, "long_for_entropy", "Over an hour: no sample entropy."},
};
static_assert(kFlags.size() == sway_flag::kCount);

consteval bool is_in_order_of_bits() {
  for (std::size_t i = 0; i < kFlags.size(); ++i) {
    if (kFlags[i].bit != 1U << i) return false;
  }
  return true;
}
static_assert(is_in_order_of_bits());

}  // namespace

std::vector<std::string_view> names_of(std::uint32_t flags) {
  std::vector<std::string_view> names;
  for (const Flag& flag : kFlags) {
    if ((flags & flag.bit) != 0) names.push_back(flag.name);
  }
  return names;
}

std::string_view sentence_of(std::uint32_t flag) {
  for (const Flag& known : kFlags) {
    if (known.bit == flag) return known.sentence;
  }
  return {};
}

}  // namespace dts::posturography
