// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "dts/v1/stream.pb.h"

namespace dts::report {

/// A decision of a model of the age group.
inline v1::SteadinessDecision made_decision() {
  v1::SteadinessDecision decision;
  decision.set_label("group60");
  decision.set_outcome(v1::DECISION_OUTCOME_DECIDED);
  decision.set_group("under60");
  for (const auto& [group, probability] : {std::pair("60plus", 0.171), {"under60", 0.829}}) {
    decision.add_probabilities()->set_group(group);
    decision.mutable_probabilities(decision.probabilities_size() - 1)->set_probability(probability);
  }
  decision.set_people(124);
  decision.set_condition("condition=ec_firm");
  decision.set_about("nearly nobody of 41 to 59");
  decision.set_auc(0.81);
  decision.set_auc_low(0.73);
  decision.set_auc_high(0.88);
  decision.set_best_measure("MVELO");
  decision.set_best_measure_auc(0.78);
  decision.set_rival("height_cm with sex");
  decision.set_rival_auc(0.83);
  return decision;
}

}  // namespace dts::report
