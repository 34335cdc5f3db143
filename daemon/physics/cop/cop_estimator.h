// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "physics/cop/cop_form.h"
#include "physics/cop/sensed_plate.h"
#include "physics/rig_model.h"

namespace dts::physics {

inline constexpr std::size_t kFloorSensors = 4;
inline constexpr std::size_t kMaxCopSensors = 32;

enum class CopMethod : std::uint8_t {
  Poly3,          ///< Quintic in two normalised differences, with several loads also in the sum (plate-model 5.2); the default.
  Thesis,         ///< Thesis 4.4, eq. 4.1: one quartic per axis in the ratio of pair averages (plate-model 5.1).
  ThesisPerPair,  ///< The other interpretation of thesis 4.4: two quartics per axis, estimates averaged; only for comparison.
  Moment,         ///< Ratio of moments of more than four sensors, for distributed contact (plate-model 5.4).
  Model,          ///< The plate model itself, inverted (plate-model 5.3): a diagnostic.
};

/// Parses "poly3", "thesis", "thesis_per_pair", "moment" or "model"; fails with InvalidArgument for anything else.
[[nodiscard]] core::Result<CopMethod> parse_cop_method(std::string_view name);
[[nodiscard]] std::string_view to_string(CopMethod method) noexcept;

/// One calibration measurement: a known load, its position (its centre of pressure if it is not a point), and the deflections of all
/// sensors in the order of the rig.
struct CopSample {
  Point load_position;
  core::Newtons load;
  std::vector<double> deflection_mm;
};

/// Restrictions of an estimate, as bits. 0 is a good estimate.
namespace cop_flag {
inline constexpr std::uint8_t kNoContact = 1U << 0;    ///< No load on the plate: all values are NaN.
inline constexpr std::uint8_t kOutsideArea = 1U << 1;  ///< Outside the calibrated area: the position is clamped to it.
inline constexpr std::uint8_t kOutsideLoad = 1U << 2;  ///< Outside the calibrated load range: the load's influence is that at the end of
                                                       ///< the range.
// Of the correction for two feet (two_feet.h).
inline constexpr std::uint8_t kOutsideTwoFeet = 1U << 3;  ///< Unlike the stances of the correction: corrected as the nearest of them.
inline constexpr std::uint8_t kOutsideTravel = 1U << 4;   ///< A deflection beyond the travel of the sensors.
inline constexpr std::uint8_t kAbout = 1U << 5;           ///< Corrected without the stance width: the load is approximate.
inline constexpr std::uint8_t kDoubtful = 1U << 6;        ///< The stated weight differs: stance width or weight is wrong.
/// Outside the calibration: the estimate is less exact than the calibration states.
inline constexpr std::uint8_t kOutside = kOutsideArea | kOutsideLoad | kOutsideTwoFeet | kOutsideTravel;
}  // namespace cop_flag

/// Returns "no_contact", "outside_area", "outside_load", "outside_two_feet", "outside_travel", "about", "doubtful" joined by '|'; empty
/// for 0.
[[nodiscard]] std::string cop_flags_text(std::uint8_t flags);

/// Centre of pressure and load. Plate coordinates (corner origin), mm and N.
struct CopEstimate {
  double x_mm = std::numeric_limits<double>::quiet_NaN();
  double y_mm = std::numeric_limits<double>::quiet_NaN();
  double load_n = std::numeric_limits<double>::quiet_NaN();
  std::uint8_t flags = cop_flag::kNoContact;

  [[nodiscard]] bool is_inside_calibration() const noexcept { return (flags & (cop_flag::kNoContact | cop_flag::kOutside)) == 0; }
};

class CopInverse;

/// A calibrated estimator. Immutable after creation; copying allocates memory. Thread: any. Realtime-safe: yes (const methods).
class CopEstimator {
 public:
  /// Fits `samples` by least squares; all must have the same number of sensors. Fails with InvalidArgument if there are too few, the system
  /// is rank deficient, or the result misses its own samples (for example because sensors are swapped).
  ///
  /// Thesis and ThesisPerPair: four sensors, five positions or more on each mid-line of the calibrated area; samples elsewhere are used
  /// only for the load and the range of the ratios. Poly3: four sensors, 6 x 6 positions for degree 5 (7 x 7 advised), 4 x 4 for degree 3.
  /// With loads a factor 1.25 or more apart, each at that many positions, Poly3 also learns how the load changes the plate's shape. Moment:
  /// five sensors or more, and at least twice as many contacts as sensors. Model: rejected, because there is nothing to fit.
  [[nodiscard]] static core::Result<CopEstimator> fit(CopMethod method, std::span<const CopSample> samples);
  /// Calibrates on the plate model of the rig (see `model_samples`). Fails with InvalidArgument if the rig's sensors do not fit the method:
  /// floor forms need four in the order w1..w4 of a floor platform.
  [[nodiscard]] static core::Result<CopEstimator> from_model(CopMethod method, const RigModel& rig,
                                                             PlateBehaviour behaviour = PlateBehaviour::Stiffening);
  /// Creates an estimator from the coefficients of a file. Fails with InvalidArgument if counts do not match, a value is not finite or a
  /// range is empty.
  [[nodiscard]] static core::Result<CopEstimator> from_form(CopMethod method, CopForm form, CopValidity validity);

  [[nodiscard]] CopMethod method() const noexcept { return method_; }
  [[nodiscard]] std::size_t sensor_count() const noexcept { return sensor_count_; }
  [[nodiscard]] const CopForm& form() const noexcept { return form_; }
  [[nodiscard]] const CopValidity& validity() const noexcept { return validity_; }

  /// `deflection_mm` has one value per sensor. Returns kNoContact and NaN for another number of values, a value that is not finite, a sum
  /// that is not positive, or deflections that no force can cause.
  ///
  /// Never extrapolates: clamps every feature (ratios, differences, shares, sum) and the position to the range of the samples, with a
  /// margin of 1 % for noise, and sets a flag.
  [[nodiscard]] CopEstimate estimate(std::span<const double> deflection_mm) const noexcept;

 private:
  CopEstimator() = default;

  CopMethod method_ = CopMethod::Poly3;
  std::size_t sensor_count_ = kFloorSensors;
  CopForm form_;
  CopValidity validity_;
  std::shared_ptr<const CopInverse> inverse_;  ///< Model only.
};

/// Loads with which `from_model` calibrates Poly3: the widest range (192..1020 N) of those tried on the stiffening floor plate that loses
/// no accuracy within 240..700 N, and the most accurate load.
inline constexpr std::array<double, 3> kModelLoadsN{240.0, 480.0, 850.0};

/// Returns the samples on which `from_model` calibrates. Thesis, ThesisPerPair: the mid-line points of thesis 4.4 at 490 N, and a separate
/// grid for the load. Poly3: a 7 x 7 grid over the sensor square at each of `kModelLoadsN`. Moment: points, one foot and two feet all over
/// the plate at several loads, from a fixed seed. Model: none.
[[nodiscard]] core::Result<std::vector<CopSample>> model_samples(CopMethod method, const RigModel& rig, PlateBehaviour behaviour);

}  // namespace dts::physics
