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

/// One reading of a sensor in front of a known gap.
struct GapReading {
  core::Millimetres gap;
  core::Volts volts;
  std::size_t row = 0;  ///< As the user counts: line of a file, number of a measurement.
};

/// What checked readings are worth.
struct SensorCalibration {
  std::vector<CurvePoint> points;  ///< Rising gap; the mean of each gap's readings.
  std::size_t least_readings = 0;  ///< Of any gap.
  double residual_v = 0.0;         ///< Of the points about a smooth curve, rms.
  std::optional<double> repeat_v;  ///< Of readings about the mean of their gap, rms; absent when no gap was read twice.
};

inline constexpr std::size_t kLeastGaps = 5;

/// Checks readings as a calibration laboratory would before it signs them, and averages those of equal gap (within 1 um).
///
/// Fails with InvalidArgument naming the row, its gap and voltage and the range that was expected, when
///  - a reading is not finite or there are fewer than `kLeastGaps` gaps,
///  - a reading does not repeat: it lies further from the median of its gap than kTolerance robust deviations (1.4826 MAD over all gaps),
///  - one gap does not lie on the smooth curve through all others: with it left out the others fit a cubic (a quadratic when there are
///    only five gaps), and it is off its prediction by more than kTolerance prediction errors. The one whose omission mends the fit most
///    is named, because a bad point spoils the prediction of good ones,
///  - the means do not keep rising, or falling, with the gap.
/// A real curve is no cubic: deviations below 0.5 % of its span (quadratic: 1.5 %) are never called outliers by less than kTolerance times.
[[nodiscard]] core::Result<SensorCalibration> calibrate_sensor(std::span<const GapReading> readings);

/// Deviations, in units of the robust deviation or prediction error, that no honest reading has.
inline constexpr double kTolerance = 5.0;

}  // namespace dts::physics
