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
  Recommended = 2,  ///< Many networks over weight-free features, an angle, the subject's own scale, a rule for arm-only reaches.
};

/// Networks with the same inputs; their outputs are averaged.
struct Ensemble {
  static constexpr std::size_t kMaxNetworks = 64;

  std::vector<FeatureRange> inputs;
  std::vector<Network> networks;
  double temperature = 1.0;  ///< Divides the logarithms of the averaged probabilities, so that a probability matches the frequency of
                             ///< correct answers.
  friend bool operator==(const Ensemble&, const Ensemble&) = default;
};

/// A quadratic over scaled inputs, clipped to their ranges: 1, each x_i, each x_i x_j with i <= j in the order 11 12 .. 1n 22 .. nn.
struct Quadratic {
  std::vector<FeatureRange> inputs;
  std::vector<double> coefficients;

  [[nodiscard]] static constexpr std::size_t term_count(std::size_t inputs) noexcept { return 1 + inputs + inputs * (inputs + 1) / 2; }
  friend bool operator==(const Quadratic&, const Quadratic&) = default;
};

/// Trunk flexion. `sine` computes the sine of the angle; over own features, the fraction of the sine at the subject's maximum reach.
struct AngleModel {
  Quadratic sine;
  /// Half width of the 90 % interval for angles of class 1, 2 and 3: a quantile of the residuals of left-out people.
  std::array<double, kClasses> residual_deg{};
  friend bool operator==(const AngleModel&, const AngleModel&) = default;
};

/// Probability that only the arm moved: logistic of a quadratic.
struct ArmAloneRule {
  Quadratic logit;
  double none_from = 0.9;  ///< Class 0 at this probability or above; high, so that a reach with a little trunk movement does not become
                           ///< class 0.
  friend bool operator==(const ArmAloneRule&, const ArmAloneRule&) = default;
};

/// Origin of a model. The texts are information for people; no computation uses them.
struct TrainingFacts {
  std::string data_sha256;  ///< Of the training features and labels, hexadecimal.
  std::vector<std::string> subjects;
  std::uint32_t simulated_subjects = 0;
  std::uint32_t trials = 0;
  std::uint64_t seed = 0;
  std::string software;
  std::string created_utc;  ///< May be empty: then the same training writes the same file.
  friend bool operator==(const TrainingFacts&, const TrainingFacts&) = default;
};

/// Expected performance. NaN: not measured.
struct ModelFigures {
  static constexpr double kUnknown = core::ReachFeatures::kUnknown;

  double validation_accuracy = kUnknown;         ///< On unseen trials of the training subjects: says little about other people.
  double left_out_accuracy = kUnknown;           ///< Each subject classified by a model trained without that subject.
  double left_out_own_accuracy = kUnknown;       ///< The same, with the subject's own scale.
  double left_out_kept = kUnknown;               ///< Fraction of left-out reaches that are not rejected.
  double left_out_kept_accuracy = kUnknown;      ///< Fraction of the kept reaches that are correct.
  double left_out_angle_rms_deg = kUnknown;      ///< Against simulated people, else against the geometry of the target.
  double left_out_angle_coverage = kUnknown;     ///< Fraction of intervals that contain the angle; each interval uses the residuals of
                                                 ///< other people.
  double expected_calibration_error = kUnknown;  ///< Of the probabilities of left-out people.
};

/// All parts of a model.
struct TrunkModelForm {
  // The reader of model files uses the same limits, so that it can name the line of a wrong value. All are allowed values.
  static constexpr double kLowestValidationAccuracy = 0.9;
  static constexpr double kLowestTemperature = 0.05;
  static constexpr double kHighestTemperature = 20.0;
  static constexpr double kLowestNoneFrom = 0.5;
  static constexpr double kSmallestP1Mm = 0.001;
  static constexpr double kLargestP1Mm = 1000.0;

  ModelKind kind = ModelKind::Raw5;
  double reject_below = 0.9;
  double p1_minimum_mm = 0.0;  ///< Range of P1 in the training data.
  double p1_maximum_mm = 0.0;
  Ensemble general;
  std::optional<Ensemble> own;  ///< Also uses own features.
  std::optional<AngleModel> angle;
  std::optional<AngleModel> own_angle;
  std::optional<ArmAloneRule> arm_alone;
  TrainingFacts facts;
  ModelFigures figures;
};

/// Fails with InvalidArgument, naming the part, if counts do not match, a number is not finite, a range is empty, a feature is not allowed
/// there, or the validation accuracy is below kLowestValidationAccuracy.
[[nodiscard]] core::Status check(const TrunkModelForm& form);

}  // namespace dts::classifier
