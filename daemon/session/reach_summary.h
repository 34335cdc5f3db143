// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "session/reach_results.h"

namespace dts::session {

/// Mean and standard deviation of finite values.
struct Spread {
  std::size_t count = 0;
  std::optional<double> mean;       ///< Nothing without a value.
  std::optional<double> deviation;  ///< Nothing with fewer than two.
};

/// The trials to one target.
struct TargetSummary {
  std::string condition{};
  std::optional<double> target_cm;
  std::optional<core::TrunkClass> expected;
  std::size_t trials = 0;
  std::size_t gaps = 0;                   ///< Trials with missing scans: they have no result.
  std::size_t found = 0;                  ///< Trials with a reach.
  std::array<std::size_t, 5> of_class{};  ///< Reaches in each class, from Rejected to Maximum.
  std::size_t agreed = 0;                 ///< Class as expected,
  std::size_t compared = 0;               ///< of these.
  Spread d2_mm;
  Spread trunk_deg;  ///< Without rejected reaches, unless nothing but their class is uncertain.
  Spread sparc;

  [[nodiscard]] std::size_t of(core::TrunkClass trunk_class) const {
    return of_class.at(static_cast<std::size_t>(static_cast<int>(trunk_class) + 1));
  }
};
/// Groups trials that are done by target, in the order in which the targets first occur.
[[nodiscard]] std::vector<TargetSummary> summarize_targets(std::span<const ReachTrialResult> results);

/// Results over all trials of a session. A result is present only if it has a value; `details` is one JSON object.
///
/// | name | unit | what |
/// |---|---|---|
/// | trials | 1 | trials that are done |
/// | reaches_detected_share | 1 | reaches found, of the trials without a gap |
/// | rejected_share | 1 | rejected reaches, of the classified ones |
/// | class_agreement_share | 1 | class equals the expected class, of the classified reaches; finding no reach agrees with "none" |
/// | trunk_at_critical_boundary_deg | deg | mean trunk flexion at P3 in reaches to the critical boundary, see below |
/// | trunk_sd_deg, d2_sd_mm | deg, mm | consistency: standard deviation within a target, pooled over the targets |
/// | sparc_mean | 1 | smoothness: spectral arc length of P1 to P3 (Balasubramanian et al. 2012), nearer 0 is smoother |
/// | targets | 1 | number of targets; `details` has all of the above per target, and the number of reaches in each class |
///
/// The critical boundary is the farthest distance that the fingertips reach without the trunk: 1.15 arm lengths (thesis 5.3). Uses only the
/// trials to the one target nearest to this distance. For a person who reaches less far, that is the nearest target within it (thesis
/// 6.4.2.1: S1). Skips targets beyond 1.2 arm lengths, which themselves require trunk flexion. Uses the angle of a rejected reach only if
/// nothing but its class is uncertain.
[[nodiscard]] std::vector<SessionFigure> summarize(std::span<const ReachTrialResult> results, const std::optional<physics::Person>& person);

}  // namespace dts::session
