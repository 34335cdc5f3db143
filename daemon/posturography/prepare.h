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

/// How the series is filtered before the measures are computed; always published with the values.
enum class Profile : std::uint8_t {
  AsIs = 1,  ///< "asis": no filter.
  Lp10 = 2,  ///< "lp10": Butterworth of 4th order, 10 Hz, forward and backward, odd-reflection padding.
};
[[nodiscard]] std::string_view name(Profile profile) noexcept;
[[nodiscard]] std::optional<Profile> profile_named(std::string_view name) noexcept;

struct Preparation {
  Profile profile = Profile::Lp10;
  /// Keeps every n-th filtered sample, with n the integer nearest to rate / analysis_rate_hz; 0 keeps all. `asis` always keeps all, because
  /// without a filter decimation would cause aliases.
  double analysis_rate_hz = 0.0;
  double trim_s = 0.0;  ///< Settling time, removed after filtering; starts at the first sample that is not missing.
};
/// The preparation for reports and for the daemon (posturography sheet section 2).
inline constexpr Preparation kReportPreparation{.profile = Profile::Lp10, .analysis_rate_hz = 100.0};

/// The series to measure: clean, filtered, even, centred.
struct Prepared {
  Profile profile = Profile::Lp10;
  double rate_hz = 0.0;       ///< Rate of analysis.
  std::vector<double> ml_mm;  ///< Minus `mean_ml_mm`.
  std::vector<double> ap_mm;
  double mean_ml_mm = 0.0;
  double mean_ap_mm = 0.0;
  double begins_s = 0.0;  ///< Time of the first sample, relative to the start of the series.
  std::uint32_t flags = 0;
  std::size_t missing = 0;       ///< Samples of the series that were missing.
  std::size_t interpolated = 0;  ///< The part of them within the analysed stretch.

  [[nodiscard]] std::size_t size() const noexcept { return ml_mm.size(); }
  /// N / rate: the T of every formula.
  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(ml_mm.size()) / rate_hz; }
};

/// Treats samples without load as missing, interpolates gaps of up to 50 ms, cuts at longer gaps (keeps the longest clean stretch),
/// filters, decimates, trims and centres (posturography sheet sections 2 and 7). Fails with InvalidArgument if columns differ in length, if
/// the rate is not between 10 and 100 000 Hz, or if the rate is too low for the profile (lp10 needs more than 20 Hz). Fails with Failed if
/// too few samples are left (2 needed; 16 for lp10); the message has their number. Thread: any.
[[nodiscard]] core::Result<Prepared> prepare(const CopSeries& series, const Preparation& preparation);

}  // namespace dts::posturography
