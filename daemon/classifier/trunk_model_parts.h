// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "classifier/trunk_model_form.h"

namespace dts::classifier {

inline constexpr double kLargestFlexionDeg = 90.0;

/// Features of one reach as input of networks and polynomials.
struct ScaledInputs {
  std::array<double, Network::kMaxInputs> values{};
  bool is_known = true;     ///< All are finite.
  bool is_in_range = true;  ///< None is far outside the training range.
};

/// `is_clipped`: a value outside its range counts as the end of the range, so that one strange feature cannot dominate a polynomial
/// (reach-model section 6: 46 to 225 degrees from one bad trial).
[[nodiscard]] ScaledInputs scale(const std::vector<FeatureRange>& inputs, const core::ReachFeatures& reach,
                                 const SubjectCalibration* subject, bool is_clipped) noexcept;

/// Returns the mean of the networks' outputs as calibrated probabilities: at least 1e-9 each, sum 1.
[[nodiscard]] Network::Outputs probabilities(const Ensemble& ensemble, const ScaledInputs& inputs) noexcept;

[[nodiscard]] double value_of(const Quadratic& quadratic, const ScaledInputs& inputs) noexcept;

[[nodiscard]] double arm_alone_probability(const ArmAloneRule& rule, const ScaledInputs& inputs) noexcept;

struct Angle {
  double deg = 0.0;
  double lowest_deg = 0.0;
  double highest_deg = 0.0;
};

/// `sine_at_maximum`: sine at the subject's own maximum reach; 1 for a general model.
[[nodiscard]] Angle angle_of(const AngleModel& model, const ScaledInputs& inputs, double sine_at_maximum) noexcept;

/// Returns the probability that the true angle is in the window of each class, with a normal distribution around the estimate.
[[nodiscard]] Network::Outputs probabilities(const Angle& angle) noexcept;

/// Returns 0, 1, 2 for class 1, 2, 3.
[[nodiscard]] std::size_t class_index(double angle_deg) noexcept;

}  // namespace dts::classifier
