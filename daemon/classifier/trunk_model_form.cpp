// SPDX-License-Identifier: Apache-2.0
#include "classifier/trunk_model_form.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace dts::classifier {
namespace {

core::Status wrong(const std::string& what) {
  return core::fail(core::ErrorCode::InvalidArgument, "trunk model: " + what, "use an unchanged model file that dtslab reach train wrote");
}

bool are_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

core::Status check_inputs(const std::string& part, const std::vector<FeatureRange>& inputs, bool may_be_own) {
  if (inputs.empty() || inputs.size() > Network::kMaxInputs) return wrong(part + " has " + std::to_string(inputs.size()) + " features");
  for (const auto& [feature, minimum, maximum] : inputs) {
    const std::string name(name_of(feature));
    if (!std::isfinite(minimum) || !std::isfinite(maximum) || !(minimum < maximum))
      return wrong(part + ": the range of " + name + " is empty");
    if (is_own(feature) && !may_be_own) return wrong(part + " must not use " + name);
    const auto same = [&feature = feature](const FeatureRange& other) { return other.feature == feature; };
    if (std::count_if(inputs.begin(), inputs.end(), same) > 1) return wrong(part + " has " + name + " twice");
  }
  return {};
}

core::Status check_ensemble(const std::string& part, const Ensemble& ensemble, bool is_of_own) {
  DTS_TRY(check_inputs(part, ensemble.inputs, is_of_own));
  if (ensemble.networks.empty() || ensemble.networks.size() > Ensemble::kMaxNetworks) {
    return wrong(part + " has " + std::to_string(ensemble.networks.size()) + " networks");
  }
  for (const Network& network : ensemble.networks) {
    if (network.input_count() != ensemble.inputs.size())
      return wrong(part + ": the number of a network's inputs differs from the number of features");
  }
  if (!(ensemble.temperature >= TrunkModelForm::kLowestTemperature && ensemble.temperature <= TrunkModelForm::kHighestTemperature))
    return wrong(part + ": the temperature is outside 0.05 to 20");
  return {};
}

core::Status check_quadratic(const std::string& part, const Quadratic& quadratic, bool is_of_own) {
  DTS_TRY(check_inputs(part, quadratic.inputs, is_of_own));
  if (quadratic.coefficients.size() != Quadratic::term_count(quadratic.inputs.size()))
    return wrong(part + " has a wrong number of coefficients");
  return are_finite(quadratic.coefficients) ? core::Status{} : wrong(part + ": a coefficient is not finite");
}

core::Status check_angle(const std::string& part, const AngleModel& angle, bool is_of_own) {
  DTS_TRY(check_quadratic(part, angle.sine, is_of_own));
  for (const double residual_deg : angle.residual_deg) {
    if (!(residual_deg > 0.0 && residual_deg <= 90.0)) return wrong(part + ": a residual is outside 0 to 90 degrees");
  }
  return {};
}

core::Status check_arm_alone(const ArmAloneRule& rule) {
  DTS_TRY(check_quadratic("arm_alone", rule.logit, false));
  if (!(rule.none_from >= TrunkModelForm::kLowestNoneFrom && rule.none_from <= 1.0))
    return wrong("arm_alone: none_from is outside 0.5 to 1");
  return {};
}

core::Status check_raw5(const TrunkModelForm& form) {
  constexpr std::array kRaw = {ReachFeature::D1, ReachFeature::D2, ReachFeature::P1, ReachFeature::P2, ReachFeature::P3};
  const auto same = [](const FeatureRange& range, ReachFeature feature) { return range.feature == feature; };
  if (!std::equal(form.general.inputs.begin(), form.general.inputs.end(), kRaw.begin(), kRaw.end(), same)) {
    return wrong("raw5 must have the features d1_mm, d2_mm, p1_mm, p2_mm, p3_mm");
  }
  if (form.general.networks.size() != 1) return wrong("raw5 must have exactly one network");
  if (form.own || form.angle || form.own_angle || form.arm_alone)
    return wrong("raw5 must have only a network: no own, angle or arm_alone part");
  return {};
}

}  // namespace

core::Status check(const TrunkModelForm& form) {
  if (form.kind != ModelKind::Raw5 && form.kind != ModelKind::Recommended) return wrong("its kind is unknown");
  if (!(form.reject_below >= 0.0 && form.reject_below <= 1.0)) return wrong("reject_below is outside 0 to 1");
  if (!(form.p1_minimum_mm >= TrunkModelForm::kSmallestP1Mm && form.p1_minimum_mm < form.p1_maximum_mm &&
        form.p1_maximum_mm <= TrunkModelForm::kLargestP1Mm))
    return wrong("the range of P1 is empty");
  DTS_TRY(check_ensemble("general", form.general, false));
  if (form.own) {
    DTS_TRY(check_ensemble("own", *form.own, true));
  }
  if (form.angle) {
    DTS_TRY(check_angle("angle", *form.angle, false));
  }
  if (form.own_angle) {
    DTS_TRY(check_angle("own_angle", *form.own_angle, true));
  }
  if (form.arm_alone) {
    DTS_TRY(check_arm_alone(*form.arm_alone));
  }
  if (form.kind == ModelKind::Raw5) {
    DTS_TRY(check_raw5(form));
  }
  if (!(form.figures.validation_accuracy >= TrunkModelForm::kLowestValidationAccuracy && form.figures.validation_accuracy <= 1.0)) {
    return wrong("its validation accuracy is below " + std::to_string(TrunkModelForm::kLowestValidationAccuracy).substr(0, 3) +
                 ": the training failed");
  }
  return {};
}

}  // namespace dts::classifier
