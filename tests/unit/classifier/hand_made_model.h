// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "classifier/trunk_model.h"

namespace dts::classifier {

/// A network of two hidden nodes that tells its first input's thirds apart: below -1/3, between, above 1/3.
inline Network thirds(std::size_t inputs) {
  std::vector<double> weights(Network::weight_count(inputs, 2));
  const double steep = 20.0;
  weights[0] = steep;
  weights[inputs] = steep;
  weights[2 * inputs] = steep / 3.0;       // +1 above -1/3
  weights[2 * inputs + 1] = -steep / 3.0;  // +1 above 1/3
  const std::size_t second = 2 * (inputs + 1);
  const std::vector<double> output = {-9.0, 0.0, 6.0, -6.0, 0.0, 9.0};
  for (std::size_t k = 0; k < output.size(); ++k) weights[second + k] = output[k];
  weights[second + 7] = -6.0;
  return Network::create(inputs, 2, OutputKind::Softmax, weights).value();
}

/// Borders of d2 / P1 at 0.2 and 0.4; the sine of the angle is 1.5 d2 / P1; below 0.04 the arm alone.
inline TrunkModelForm hand_made_form() {
  const FeatureRange range{ReachFeature::RelativeD2, 0.0, 0.6};
  TrunkModelForm form{.kind = ModelKind::Recommended, .general = {}, .facts = {}, .figures = {}};
  form.p1_minimum_mm = 3.0;
  form.p1_maximum_mm = 4.5;
  form.general = {.inputs = {range}, .networks = {thirds(1)}};
  form.own = Ensemble{.inputs = {{ReachFeature::OwnD2, 0.0, 1.2}}, .networks = {thirds(1)}};
  form.angle = AngleModel{.sine = {.inputs = {range}, .coefficients = {0.45, 0.45, 0.0}}, .residual_deg = {3.0, 6.0, 9.0}};
  form.own_angle =
      AngleModel{.sine = {.inputs = {{ReachFeature::OwnD2, 0.0, 1.2}}, .coefficients = {0.6, 0.6, 0.0}}, .residual_deg = {2.0, 4.0, 6.0}};
  form.arm_alone = ArmAloneRule{.logit = {.inputs = {{ReachFeature::RelativeD2, 0.0, 0.08}}, .coefficients = {0.0, -20.0, 0.0}}};
  form.facts = {
      .data_sha256 = std::string(64, 'a'), .subjects = {"A", "B \"b\""}, .trials = 90, .seed = ~std::uint64_t{0}, .software = "test"};
  form.figures.validation_accuracy = 0.97;
  return form;
}

/// A reach whose d2 is this part of P1.
inline core::ReachFeatures reach_of(double relative_d2, double p1_mm = 3.5) {
  return {.p1_mm = p1_mm,
          .p2_mm = p1_mm * 0.95,
          .p3_mm = p1_mm * (1.0 + relative_d2),
          .hold_mm = 0.9 * relative_d2 * p1_mm,
          .rise_s = 0.9,
          .rest_ratio = -0.2,
          .ratio_change = relative_d2 / 4.0,
          .twist = 0.0,
          .smoothness = -2.0};
}

}  // namespace dts::classifier
