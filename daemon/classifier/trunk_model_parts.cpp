// SPDX-License-Identifier: Apache-2.0
#include "classifier/trunk_model_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "classifier/trunk_model.h"

namespace dts::classifier {
namespace {

constexpr double kFarOutside = 0.5;  ///< Of half the range, beyond its end: other people reach slightly farther.
constexpr double kLeastProbability = 1e-9;
constexpr double kNinetyPercent = 1.6449;  ///< Half width of a normal distribution's 90 % interval, in standard deviations.

double normal_below(double deviations) noexcept { return 0.5 * std::erfc(-deviations / std::numbers::sqrt2); }

/// Returns whether a value outside the range is clipped and never causes a rejection. A slow reach is still a reach. The ratio at rest
/// depends on the seat's sensors as much as on the person; clipped, a shift of 0.04 costs 0.5 % of the answers.
bool is_only_clipped(ReachFeature feature) noexcept { return feature == ReachFeature::Rise || feature == ReachFeature::RestRatio; }

Network::Outputs normalised(Network::Outputs values) noexcept {
  double total = 0.0;
  for (double& value : values) total += value = std::max(value, kLeastProbability);
  for (double& value : values) value /= total;
  return values;
}

}  // namespace

ScaledInputs scale(const std::vector<FeatureRange>& inputs, const core::ReachFeatures& reach, const SubjectCalibration* subject,
                   bool is_clipped) noexcept {
  ScaledInputs result;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const double scaled = inputs[k].scaled(value_of(inputs[k].feature, reach, subject));
    if (!std::isfinite(scaled)) {
      result.is_known = false;
      continue;
    }
    if (!is_only_clipped(inputs[k].feature) && std::abs(scaled) > 1.0 + kFarOutside) result.is_in_range = false;
    result.values[k] = is_clipped ? std::clamp(scaled, -1.0, 1.0) : scaled;
  }
  return result;
}

Network::Outputs probabilities(const Ensemble& ensemble, const ScaledInputs& inputs) noexcept {
  Network::Outputs mean{};
  for (const Network& network : ensemble.networks) {
    const auto one = normalised(network.outputs(std::span(inputs.values).first(ensemble.inputs.size())));
    for (std::size_t k = 0; k < kClasses; ++k) mean[k] += one[k];
  }
  mean = normalised(mean);
  for (double& value : mean) value = std::pow(value, 1.0 / ensemble.temperature);
  return normalised(mean);
}

double value_of(const Quadratic& quadratic, const ScaledInputs& inputs) noexcept {
  const std::size_t count = quadratic.inputs.size();
  const double* coefficient = quadratic.coefficients.data();
  double value = *coefficient++;
  for (std::size_t i = 0; i < count; ++i) value += *coefficient++ * inputs.values[i];
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i; j < count; ++j) value += *coefficient++ * inputs.values[i] * inputs.values[j];
  }
  return value;
}

double arm_alone_probability(const ArmAloneRule& rule, const ScaledInputs& inputs) noexcept {
  return 1.0 / (1.0 + std::exp(-std::clamp(value_of(rule.logit, inputs), -500.0, 500.0)));
}

std::size_t class_index(double angle_deg) noexcept {
  if (angle_deg < kModerateFromDeg) return 0;
  return angle_deg < kMaximumFromDeg ? 1 : 2;
}

Angle angle_of(const AngleModel& model, const ScaledInputs& inputs, double sine_at_maximum) noexcept {
  const double sine = std::clamp(value_of(model.sine, inputs) * sine_at_maximum, 0.0, 1.0);
  const double deg = std::asin(sine) * 180.0 / std::numbers::pi;
  const double residual_deg = model.residual_deg[class_index(deg)];
  return {.deg = deg, .lowest_deg = std::max(0.0, deg - residual_deg), .highest_deg = std::min(kLargestFlexionDeg, deg + residual_deg)};
}

Network::Outputs probabilities(const Angle& angle) noexcept {
  // The interval may be cut at 0 or 90 degrees, so its wider side is the uncertainty of the estimate.
  const double half_width_deg = std::max(angle.highest_deg - angle.deg, angle.deg - angle.lowest_deg);
  const double deviation_deg = std::max(half_width_deg, 0.1) / kNinetyPercent;
  const double below_moderate = normal_below((kModerateFromDeg - angle.deg) / deviation_deg);
  const double below_maximum = normal_below((kMaximumFromDeg - angle.deg) / deviation_deg);
  return normalised({below_moderate, below_maximum - below_moderate, 1.0 - below_maximum});
}

}  // namespace dts::classifier
