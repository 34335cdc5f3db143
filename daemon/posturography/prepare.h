// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "posturography/cop_series.h"

namespace dts::posturography {

/// How the series is filtered before it is measured; always told with the values.
enum class Profile : std::uint8_t {
  AsIs = 1,  ///< "asis": not at all.
  Lp10 = 2,  ///< "lp10": Butterworth of 4th order, 10 Hz, forward and backward, odd-reflection padding.
};
[[nodiscard]] std::string_view name(Profile profile) noexcept;
[[nodiscard]] std::optional<Profile> profile_named(std::string_view name) noexcept;

struct Preparation {
  Profile profile = Profile::Lp10;
  /// Every n-th filtered sample is kept, n the whole number nearest to rate / this; 0: all. `asis` keeps all in any case: nothing would
  /// keep aliases out.
  double analysis_rate_hz = 0.0;
  double trim_s = 0.0;  ///< Settling time, taken off after filtering; it begins with the first sample there is.
};
/// What reports and the daemon use (posturography sheet section 2).
inline constexpr Preparation kReportPreparation{.profile = Profile::Lp10, .analysis_rate_hz = 100.0};

/// What is measured: clean, filtered, even, centred.
struct Prepared {
  Profile profile = Profile::Lp10;
  double rate_hz = 0.0;       ///< Of analysis.
  std::vector<double> ml_mm;  ///< Less `mean_ml_mm`.
  std::vector<double> ap_mm;
  double mean_ml_mm = 0.0;
  double mean_ap_mm = 0.0;
  double begins_s = 0.0;  ///< Of the first sample, from the first of the series.
  std::uint32_t flags = 0;
  std::size_t missing = 0;       ///< Samples of the series that were missing.
  std::size_t interpolated = 0;  ///< Of these, within what was analysed.

  [[nodiscard]] std::size_t size() const noexcept { return ml_mm.size(); }
  /// N / rate: the T of every formula.
  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(ml_mm.size()) / rate_hz; }
};

/// Rejects, interpolates gaps of up to 50 ms, cuts at longer ones (the longest clean stretch is kept), filters, decimates, trims, centres:
/// posturography sheet sections 2 and 7. InvalidArgument: columns of different length, a rate that is not between 10 and 100 000 Hz, or
/// one too low for the profile (lp10 needs more than 20 Hz). Failed: too little is left (2 samples; 16 for lp10), saying how much there
/// was. Thread: any.
[[nodiscard]] core::Result<Prepared> prepare(const CopSeries& series, const Preparation& preparation);

}  // namespace dts::posturography
