// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/result.h"
#include "posturography/cop_series.h"

namespace dts::posturography {

inline constexpr double kGravity = 9.81;  ///< m/s2. The thesis has 9.8: physics::kGravityMPerS2, which this room must not include.
/// The band in which the horizontal force follows from the centre of pressure, Hz. Below it, posture changes slowly in ways that are not a
/// pendulum's, and 0.1 N of signal is left; above it, trunk, arms and heart move apart from the whole body.
inline constexpr double kLowestForceHz = 0.1;
inline constexpr double kHighestForceHz = 2.0;
/// The result begins this long after the first sample of a stretch and ends as long before its last: the filter has no support there.
inline constexpr double kForceMarginS = 3.0;
/// Shorter stretches have no result: two periods of the lowest frequency, and the margins.
inline constexpr double kShortestForceS = 2.0 / kLowestForceHz + 2.0 * kForceMarginS;

/// The horizontal force of the ground on a standing person, estimated from the centre of pressure. All columns have the length of the
/// series; NaN where the filter has no support.
struct GroundReaction {
  std::vector<double> ml_n;  ///< Each supported stretch has about zero mean: a constant force does not move the centre of pressure.
  std::vector<double> ap_n;
  double mass_kg = 0.0;             ///< From the mean load of the stretches that have a result.
  double load_sd_n = 0.0;           ///< Standard deviation of this load.
  double effective_length_m = 0.0;  ///< I / (m h) of an inverted pendulum that turns about the ankles.
  std::size_t supported = 0;        ///< Samples with a result.
};

/// Estimates the force for a person of `body_height_m`. The person counts as an inverted pendulum: x'' = (g / l) (x - p), with x the centre
/// of mass, p the centre of pressure and l = 1.25 x 0.55 of the body height. So X(w) = P(w) w0^2 / (w0^2 + w^2) with w0^2 = g / l, and
/// F = m x'' (Brenière 1996; Caron, Faure & Brenière 1997; Winter 1998), without phase, between the two frequencies above. One foot against
/// the other, steps, and movements of the hips are not in it.
///
/// Samples without load or with gaps longer than 50 ms separate stretches; each is computed alone. Fails with InvalidArgument if the body
/// height is not 0.5 to 2.5 m, if the series has no load, if columns differ in length, or if the rate is below 10 Hz; fails with Failed if
/// no stretch is long enough. Thread: any.
[[nodiscard]] core::Result<GroundReaction> ground_reaction(const CopSeries& series, double body_height_m);

}  // namespace dts::posturography
