// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "core/reach.h"
#include "core/result.h"

namespace dts::classifier {

inline constexpr std::size_t kCalibrationReaches = 3;

/// One person's own scale. Most failures of a general model concern a whole person, not a single trial (reach-model section 6).
struct SubjectCalibration {
  double max_d2_mm = 0.0;        ///< Median d2 of the subject's own maximum reaches.
  double max_flexion_deg = 0.0;  ///< Trunk flexion of a maximum reach, from the subject's measures (physics::trunk_flexion_deg).
  double max_hold_mm = core::ReachFeatures::kUnknown;  ///< Medians of further features of these reaches; NaN if one reach lacks the
                                                       ///< feature.
  double max_ratio_change = core::ReachFeatures::kUnknown;
  core::ReachFeatures maximum{};  ///< Median of each feature: a general model classifies these reaches without knowledge of the person.
};

/// Computes the scale from `kCalibrationReaches` or more maximum reaches. Fails with InvalidArgument if there are fewer, one is minor or
/// not finite, they differ too much, or the flexion is not in (0, 90] degrees.
[[nodiscard]] core::Result<SubjectCalibration> calibrate_subject(std::span<const core::ReachFeatures> maximum_reaches,
                                                                 double max_flexion_deg);

}  // namespace dts::classifier
