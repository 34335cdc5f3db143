// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/result.h"
#include "posturography/measure.h"
#include "posturography/prepare.h"

namespace dts::posturography {

/// All results of one trial.
struct Analysis {
  Profile profile = Profile::Lp10;
  double rate_hz = 0.0;
  std::size_t samples = 0;
  double duration_s = 0.0;
  std::uint32_t flags = 0;
  std::size_t missing = 0;
  std::size_t interpolated = 0;
  Measures measures;

  /// false: the subject stepped off or moved the feet, so the values do not describe steadiness.
  [[nodiscard]] bool is_valid() const noexcept { return (flags & sway_flag::kInvalid) == 0; }
  /// true: a gap made it shorter than its trial.
  [[nodiscard]] bool is_cut() const noexcept { return (flags & sway_flag::kCutAtGap) != 0; }
};

struct AnalysisOptions {
  Preparation preparation{};
  std::optional<double> foot_length_mm;  ///< Needed for AP_USE.
};

/// Computes every measure that is defined for `prepared`. Thread: any.
[[nodiscard]] Analysis analyse(const Prepared& prepared, std::optional<double> foot_length_mm = std::nullopt);
/// Calls `prepare`, then `analyse`; fails as `prepare`.
[[nodiscard]] core::Result<Analysis> analyse(const CopSeries& series, const AnalysisOptions& options);

}  // namespace dts::posturography
