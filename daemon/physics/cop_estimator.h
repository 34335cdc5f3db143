// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "physics/plate.h"
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
  /// Least squares through `samples`. Fails with InvalidArgument when there are too few or the system is rank deficient.
  [[nodiscard]] static core::Result<CopEstimator> fit(CopMethod method, std::span<const CopSample> samples);
  /// Calibrated on the plate model of the rig, as plate-model section 5 does: mid-line points for Thesis, a 7 x 7 grid
  /// over the sensor square for Poly3. Fails unless the rig has four sensors in the order w1..w4 of a floor platform.
  [[nodiscard]] static core::Result<CopEstimator> from_model(CopMethod method, const RigModel& rig);

  [[nodiscard]] CopMethod method() const noexcept { return method_; }
  /// Meaningful only when the sum of deflections is positive; otherwise all values are NaN.
  [[nodiscard]] CopEstimate estimate(const std::array<double, kFloorSensors>& deflection_mm) const noexcept;

 private:
  CopEstimator() = default;
  // The implementer of cop_estimator.cpp fills this in.
  CopMethod method_ = CopMethod::Poly3;
};

}  // namespace dts::physics
