// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "physics/sensor_curve.h"

namespace dts::physics {

/// One reading of a sensor at a known gap.
struct GapReading {
  core::Millimetres gap;
  core::Volts volts;
  std::size_t row = 0;  ///< Number that the user sees: line of a file, or number of a measurement.
};

/// Checked readings and their quality.
struct SensorCalibration {
  std::vector<CurvePoint> points;  ///< In order of rising gap; the mean of each gap's readings.
  std::size_t least_readings = 0;  ///< Smallest number of readings of any gap.
  double residual_v = 0.0;         ///< Deviation of the points from a smooth curve, rms.
  std::optional<double> repeat_v;  ///< Deviation of readings from the mean of their gap, rms; absent if every gap has only one reading.
};

inline constexpr std::size_t kLeastGaps = 5;

/// Checks readings as a calibration laboratory does, and averages readings of equal gap (within 1 um).
///
/// Fails with InvalidArgument, naming the row, its gap and voltage and the expected range, if
///  - a reading is not finite or there are fewer than `kLeastGaps` gaps,
///  - a reading does not repeat: it differs from the median of its gap by more than kTolerance robust deviations (1.4826 MAD over all
///    gaps),
///  - one gap does not lie on the smooth curve through all others: without it the others fit a cubic (a quadratic if there are only five
///    gaps), and it differs from the prediction by more than kTolerance prediction errors. The message names the gap whose omission
///    improves the fit most, because a bad point spoils the prediction of good ones,
///  - the means do not keep rising, or falling, with the gap.
/// A real curve is not a cubic: the scatter about the fit counts as at least 0.5 % of the span (quadratic: 1.5 %).
[[nodiscard]] core::Result<SensorCalibration> calibrate_sensor(std::span<const GapReading> readings);

/// Largest deviation of a valid reading, in robust deviations or prediction errors.
inline constexpr double kTolerance = 5.0;

}  // namespace dts::physics
