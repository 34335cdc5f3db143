// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "classifier/network.h"
#include "classifier/reach_feature.h"
#include "core/result.h"

namespace dts::classifier {

enum class ModelKind : std::uint8_t {
  Raw5 = 1,         ///< One network over d1, d2, P1, P2, P3, as in the thesis.
  Recommended = 2,  ///< Many networks over weight-free features, an angle, the subject's own scale, a rule for the arm alone.
};

/// Networks over the same inputs; their outputs are averaged.
struct Ensemble {
  static constexpr std::size_t kMaxNetworks = 64;

  std::vector<FeatureRange> inputs;
  std::vector<Network> networks;
  double temperature = 1.0;  ///< Divides the logarithms of the averaged probabilities, so that they are as often right as they say.
  friend bool operator==(const Ensemble&, const Ensemble&) = default;
};

/// A quadratic over scaled inputs, clipped to their ranges: 1, each x_i, each x_i x_j with i <= j in the order 11 12 .. 1n 22 .. nn.
struct Quadratic {
  std::vector<FeatureRange> inputs;
  std::vector<double> coefficients;

  [[nodiscard]] static constexpr std::size_t term_count(std::size_t inputs) noexcept { return 1 + inputs + inputs * (inputs + 1) / 2; }
  friend bool operator==(const Quadratic&, const Quadratic&) = default;
};

/// Trunk flexion. `sine` gives the sine of the angle, or, over own features, its part of the sine at the subject's maximum reach.
struct AngleModel {
  Quadratic sine;
  /// Half width of the 90 % interval where the angle is that of class 1, 2 and 3: a quantile of residuals of people left out.
  std::array<double, kClasses> residual_deg{};
  friend bool operator==(const AngleModel&, const AngleModel&) = default;
};

/// Probability that only the arm moved: logistic of a quadratic.
struct ArmAloneRule {
  Quadratic logit;
  double none_from = 0.9;  ///< Class 0 from this probability on; below, a reach that moved the trunk a little is not lost to it.
  friend bool operator==(const ArmAloneRule&, const ArmAloneRule&) = default;
};

/// Where a model comes from. Texts are for people; nothing is computed with them.
struct TrainingFacts {
  std::string data_sha256;  ///< Of the features and labels it was trained on, hexadecimal.
  std::vector<std::string> subjects;
  std::uint32_t simulated_subjects = 0;
  std::uint32_t trials = 0;
  std::uint64_t seed = 0;
  std::string software;
  std::string created_utc;  ///< May be empty: then the same training gives the same file.
  friend bool operator==(const TrainingFacts&, const TrainingFacts&) = default;
};

/// What to expect of it. NaN: not measured.
struct ModelFigures {
  static constexpr double kUnknown = core::ReachFeatures::kUnknown;

  double validation_accuracy = kUnknown;         ///< Of trials not trained on, of the same people: says little about others.
  double left_out_accuracy = kUnknown;           ///< Each subject by a model without that subject.
  double left_out_own_accuracy = kUnknown;       ///< The same with the subject's own scale.
  double left_out_kept = kUnknown;               ///< Part of these that are not rejected,
  double left_out_kept_accuracy = kUnknown;      ///< and how many of them are right.
  double left_out_angle_rms_deg = kUnknown;      ///< Against simulated people, else the geometry of the target.
  double left_out_angle_coverage = kUnknown;     ///< Part of the intervals that hold it; each by the residuals of other people.
  double expected_calibration_error = kUnknown;  ///< Of the probabilities, left out.
};

/// Everything a model is made of.
struct TrunkModelForm {
  static constexpr double kLowestValidationAccuracy = 0.9;

  ModelKind kind = ModelKind::Raw5;
  double reject_below = 0.9;
  double p1_minimum_mm = 0.0;  ///< Levels of the people it was trained on.
  double p1_maximum_mm = 0.0;
  Ensemble general;
  std::optional<Ensemble> own;  ///< Over own features too.
  std::optional<AngleModel> angle;
  std::optional<AngleModel> own_angle;
  std::optional<ArmAloneRule> arm_alone;
  TrainingFacts facts;
  ModelFigures figures;
};

/// Fails with InvalidArgument, naming the part, when counts do not fit, a number is not finite, a range is empty, a feature does not belong
/// there, or the validation accuracy is below kLowestValidationAccuracy.
[[nodiscard]] core::Status check(const TrunkModelForm& form);

}  // namespace dts::classifier
