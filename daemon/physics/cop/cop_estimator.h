// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/result.h"
#include "core/units.h"
#include "physics/cop/quintic.h"
#include "physics/plate/plate.h"
#include "physics/rig_model.h"

namespace dts::physics {

inline constexpr std::size_t kFloorSensors = 4;

/// One calibration measurement: a known point load and the four deflections it causes.
struct CopSample {
  Point load_position;
  core::Newtons load;
  std::array<double, kFloorSensors> deflection_mm{};
};

/// Centre of pressure and load from four deflections. Plate coordinates (corner origin), mm and N.
struct CopEstimate {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double load_n = 0.0;
  bool is_inside_calibration = true;  ///< false: clamped to, or extrapolated from, the calibrated range.
};

enum class CopMethod : std::uint8_t {
  Thesis,  ///< Thesis 4.4, eq. 4.1: one quartic per axis in the ratio of pair averages (plate-model 5.1).
  Poly3,   ///< Quintic in two normalised differences (plate-model 5.2); the default.
};

/// "thesis", "poly3"; fails with InvalidArgument for anything else.
[[nodiscard]] core::Result<CopMethod> parse_cop_method(std::string_view name);

/// A calibrated estimator. Immutable after creation. Thread: any. Realtime-safe: yes.
class CopEstimator {
 public:
  /// Least squares through `samples`. Fails with InvalidArgument when there are too few, the system is rank deficient or the
  /// result does not meet its own samples, as with swapped sensors.
  ///
  /// Thesis needs five positions or more on each mid-line of the calibrated area; samples elsewhere improve the load only.
  /// Poly3 needs 6 x 6 positions for degree 5 (7 x 7 advised) and 4 x 4 for degree 3. With loads at least a factor 2 apart, each
  /// at that many positions, Poly3 also learns how the load changes the plate's shape.
  [[nodiscard]] static core::Result<CopEstimator> fit(CopMethod method, std::span<const CopSample> samples);
  /// Calibrated on the plate model of the rig, as plate-model section 5 does: mid-line points for Thesis, a 7 x 7 grid
  /// over the sensor square for Poly3. Fails unless the rig has four sensors in the order w1..w4 of a floor platform.
  [[nodiscard]] static core::Result<CopEstimator> from_model(CopMethod method, const RigModel& rig);

  [[nodiscard]] CopMethod method() const noexcept { return method_; }
  /// Meaningful only when the deflections are finite and their sum is positive; otherwise all values are NaN.
  ///
  /// "Inside" means: every feature (ratios, normalised differences, with several loads also the sum) and the position lie in
  /// the range the samples had, with a margin of 1 % of it for noise. Features beyond are clamped, so that the result is bounded.
  [[nodiscard]] CopEstimate estimate(const std::array<double, kFloorSensors>& deflection_mm) const noexcept;

 private:
  friend class CopFit;

  /// Calibrated range of a feature.
  struct Interval {
    double lowest = 0.0;
    double highest = 0.0;

    [[nodiscard]] bool contains(double value) const noexcept { return value >= lowest && value <= highest; }
    [[nodiscard]] double clamp(double value) const noexcept { return value < lowest ? lowest : value > highest ? highest : value; }
  };
  /// Coefficients of (r - 1)^k.
  using Quartic = std::array<double, 5>;

  CopEstimator() = default;

  CopMethod method_ = CopMethod::Poly3;
  Interval u_;  ///< (w2 + w4 - w1 - w3) / S: to the right.
  Interval v_;  ///< (w3 + w4 - w1 - w2) / S: upwards.
  Interval x_mm_;
  Interval y_mm_;
  // Thesis only.
  Interval x_ratio_;  ///< (w1 + w3) / (w2 + w4)
  Interval y_ratio_;  ///< (w1 + w2) / (w3 + w4)
  Quartic x_quartic_{};
  Quartic y_quartic_{};
  // Outputs x mm, y mm, sum of deflections per load mm/N; for Thesis the last one only.
  Quintic polynomial_;
  // Calibrated at several loads only: what the sum of deflections, in units of `reference_sum_mm_`, adds.
  bool uses_sum_ = false;
  double reference_sum_mm_ = 1.0;
  Interval relative_sum_;
  Quintic sum_polynomial_;
};

}  // namespace dts::physics
