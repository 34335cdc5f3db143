// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/units.h"

namespace dts::core {

/// Longest time that the values outside a trial cover.
inline constexpr double kRecentSwayS = 30.0;

/// Running values of quiet standing: the steadiness measures that can be exact while the trial runs (posturography sheet section
/// 3, "live"). Computed from the causally filtered centre of pressure of a window, with the formulas of the final values. mm,
/// mm/s, mm2. With 0 samples no value is valid; the ellipse needs at least three samples.
struct RunningSway {
  std::uint64_t samples = 0;  ///< Number of samples at the analysis rate.
  double rate_hz = 0.0;       ///< Analysis rate; samples / rate_hz is the duration.
  double mean_ml_mm = 0.0;
  double mean_ap_mm = 0.0;
  double rdist_mm = 0.0;
  double rdist_ap_mm = 0.0;
  double rdist_ml_mm = 0.0;
  double totex_mm = 0.0;
  double totex_ap_mm = 0.0;
  double totex_ml_mm = 0.0;
  double range_ap_mm = 0.0;
  double range_ml_mm = 0.0;
  double ellipse_sd1_mm = 0.0;     ///< Square root of the larger eigenvalue of the sample covariance.
  double ellipse_sd2_mm = 0.0;     ///< Square root of the smaller eigenvalue.
  double ellipse_angle_deg = 0.0;  ///< Angle of the major axis from +ML, -90 .. 90.
  double pea95_f_mm2 = 0.0;
};

/// Published by the stage `steadiness` while a person stands; preliminary.
struct SwayEvent {
  std::uint32_t segment = 0;
  ScanIndex scan;                 ///< Newest scan in the values, of the rig's raw stream.
  std::int64_t host_time_ns = 0;  ///< Host time of that scan.
  ScanIndex first_scan;           ///< First scan of the window.
  /// The window is the measuring time of this trial so far; 0: the last `kRecentSwayS` at most, since the person stands still.
  std::uint32_t trial = 0;
  RunningSway values;
};

}  // namespace dts::core
