// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/units.h"

namespace dts::core {

/// Running values of quiet standing: those of the steadiness measures that can be exact while the trial runs (posturography sheet section
/// 3, "live"). Of the causally filtered centre of pressure since the window began, by the same formulas as the final values. mm, mm/s, mm2.
/// 0 samples: nothing is known, and no value means anything; the ellipse is known from three samples on.
struct RunningSway {
  std::uint64_t samples = 0;  ///< At the rate of analysis.
  double rate_hz = 0.0;       ///< Of analysis; samples / rate_hz is the duration.
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
  double ellipse_sd1_mm = 0.0;  ///< Square roots of the eigenvalues of the sample covariance, the larger first.
  double ellipse_sd2_mm = 0.0;
  double ellipse_angle_deg = 0.0;  ///< Of the major axis from +ML, -90 .. 90.
  double pea95_f_mm2 = 0.0;
};

/// Told by the stage `steadiness` while somebody stands: preliminary.
struct SwayEvent {
  std::uint32_t segment = 0;
  ScanIndex scan;                 ///< The newest that counts, of the rig's raw stream.
  std::int64_t host_time_ns = 0;  ///< Of that scan.
  ScanIndex first_scan;           ///< Where the window began.
  std::uint32_t trial = 0;        ///< The window is this trial's measuring time; 0: it began when somebody stepped on.
  RunningSway values;
};

}  // namespace dts::core
