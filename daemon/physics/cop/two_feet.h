// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "core/result.h"
#include "physics/cop/cop_estimator.h"

// The correction for a person on two feet. Four sensors cannot distinguish two feet from a point. But if it is known that there are two
// feet, load, position and the size of the sway can be corrected, and better if their distance is known too (sheet two-feet).

namespace dts::physics {

/// Polynomials of the point calibration's estimate: what to add to the position, and the logarithm of a factor of the load.
struct TwoFeetPolynomial {
  static constexpr std::size_t kMaxFeatures = 4;
  static constexpr std::size_t kTermCount = 35;
  static constexpr std::size_t kMaxDegree = 4;

  struct Feature {
    double mean = 0.0;
    double sd = 1.0;   ///< Standard deviation; a polynomial's argument is (value - mean) / sd.
    Interval range{};  ///< Of the stances that the polynomials were fitted to.

    friend bool operator==(const Feature&, const Feature&) = default;
  };
  /// In the order x mm, y mm, load N, stance width mm. Without the width there are three.
  std::array<Feature, kMaxFeatures> features{};
  std::size_t feature_count = kMaxFeatures;
  std::array<double, kTermCount> x_mm{};  ///< One per term, in the order of `terms_of`.
  std::array<double, kTermCount> y_mm{};
  std::array<double, kTermCount> log_load{};  ///< Of the factor of the load.

  /// Returns 3 for four features and 4 for three: both have 35 terms.
  [[nodiscard]] static constexpr std::size_t degree(std::size_t feature_count) noexcept { return feature_count == kMaxFeatures ? 3 : 4; }
  /// Returns every product a^i b^j c^k d^l of the first `feature_count` arguments with i + j + k + l <= degree; i rises slowest, then j,
  /// then k. Realtime-safe: yes.
  [[nodiscard]] static std::array<double, kTermCount> terms_of(const std::array<double, kMaxFeatures>& arguments,
                                                               std::size_t feature_count) noexcept;

  friend bool operator==(const TwoFeetPolynomial&, const TwoFeetPolynomial&) = default;
};

/// The result of `fit_two_feet`, as plain values.
struct TwoFeetForm {
  TwoFeetPolynomial with_width{};     ///< Four features.
  TwoFeetPolynomial without_width{};  ///< Three features: less exact, for a person whose stance width is unknown.
  double travel_mm = 5.0;             ///< The sensors measure deflections up to this one.

  friend bool operator==(const TwoFeetForm&, const TwoFeetForm&) = default;
};

/// The correction of one rig. Immutable after creation. Thread: any. Realtime-safe: yes (const methods).
class TwoFeetCorrection {
 public:
  /// Fails with InvalidArgument if a value is not finite, a standard deviation or the travel is not positive, or a range is empty or more
  /// than 100 standard deviations wide to a side.
  [[nodiscard]] static core::Result<TwoFeetCorrection> from_form(const TwoFeetForm& form);

  [[nodiscard]] const TwoFeetForm& form() const noexcept { return form_; }

  /// Returns the estimate for a person on two feet. `point` is the estimate of the point calibration from `deflection_mm`; an estimate
  /// without contact is returned unchanged. `width_mm` is the distance between the middle lines of the feet; nothing: unknown, and the
  /// result has kAbout.
  ///
  /// Never extrapolates: a feature outside the range of the fitted stances counts as the end of the range, and sets kOutsideTwoFeet. A
  /// deflection beyond the sensors' travel sets kOutsideTravel.
  [[nodiscard]] CopEstimate apply(const CopEstimate& point, std::span<const double> deflection_mm,
                                  std::optional<double> width_mm) const noexcept;
  /// Returns whether a person on two feet can have this estimate of the point calibration: its position is in the range of the fitted
  /// stances.
  [[nodiscard]] bool covers_position(const CopEstimate& point) const noexcept;

 private:
  explicit TwoFeetCorrection(const TwoFeetForm& form) : form_(form) {}

  TwoFeetForm form_;
};

/// A stated weight that differs from the measured load by more than this part makes weight or stance width doubtful.
inline constexpr double kDoubtfulLoadPart = 0.05;

/// Returns whether the stated weight or the stated stance width must be wrong: the measured load differs too much. The weight only checks
/// the measurement, it never replaces the load.
[[nodiscard]] bool is_load_doubtful(double measured_n, double stated_n) noexcept;

}  // namespace dts::physics
