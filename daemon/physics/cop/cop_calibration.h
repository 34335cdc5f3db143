// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "physics/cop/cop_estimator.h"
#include "physics/cop/two_feet.h"

namespace dts::physics {

/// Returns whether `text` has exactly the form "2026-01-31T12:00:00Z".
[[nodiscard]] bool is_utc_time(std::string_view text) noexcept;

/// Where and when a calibration was measured. `rig`, `daq_model` and `daq_serial` may be empty (unknown); `created_utc` must not.
struct CopCalibrationOrigin {
  std::string created_utc;  ///< ISO 8601: "2026-01-31T12:00:00Z"
  std::string rig;
  std::string daq_model;  ///< "USB-6008"
  std::string daq_serial;
};

/// A calibration load and the error of the finished estimator: estimate minus truth.
struct CopCalibrationPoint {
  CopSample sample;
  double x_error_mm = 0.0;
  double y_error_mm = 0.0;
  double load_error_percent = 0.0;
};

[[nodiscard]] CopCalibrationPoint compare(const CopSample& sample, const CopEstimate& estimate);

/// Root mean squares over points; `total` is radial.
struct CopErrorFigures {
  double rms_x_mm = 0.0;
  double rms_y_mm = 0.0;
  double rms_total_mm = 0.0;
  double max_total_mm = 0.0;
  double load_rms_percent = 0.0;
};

[[nodiscard]] CopErrorFigures error_figures(std::span<const CopCalibrationPoint> points);

/// A calibration of a rig. `dtsctl calibrate cop` and `dtslab cop fit` create it from measurements, `dtslab cop two-feet` from the plate
/// model if there are none; the cop stage uses it.
struct CopCalibration {
  std::string id;  ///< "cop-20260131T120000Z-1a2b3c4d": date and a checksum of method and samples.
  CopCalibrationOrigin origin;
  CopEstimator estimator;  ///< Its `validity()` is the calibrated area and load range.
  std::vector<CopCalibrationPoint> points;
  CopErrorFigures residuals;  ///< Errors at the calibration's own points.
  /// Errors at each point by an estimator fitted without that point; its load error is the stated error of the load. Absent if there are
  /// too few points for the check (the position of Thesis is interpolated).
  std::optional<CopErrorFigures> cross_validated;
  /// For a person on two feet, on top of `estimator`; `dtslab cop two-feet` adds it.
  std::optional<TwoFeetCorrection> two_feet{};

  /// Stated error of the load, rms %: cross-validated when possible.
  [[nodiscard]] double load_error_percent() const noexcept {
    return cross_validated ? cross_validated->load_rms_percent : residuals.load_rms_percent;
  }
};

/// Fits and computes the errors. Fails as CopEstimator::fit, and with InvalidArgument for an invalid date.
[[nodiscard]] core::Result<CopCalibration> calibrate_cop(CopMethod method, std::span<const CopSample> samples, CopCalibrationOrigin origin);

}  // namespace dts::physics
