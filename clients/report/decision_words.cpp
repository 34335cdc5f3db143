// SPDX-License-Identifier: Apache-2.0
#include "report/decision_words.h"

#include <algorithm>

#include "core/join.h"
#include "report/number_text.h"

namespace dts::report {
namespace {

std::string named(const google::protobuf::RepeatedPtrField<std::string>& symbols, const std::string& says) {
  const std::vector<std::string> names(symbols.begin(), symbols.end());
  return core::join(names) + (names.size() == 1 ? " is " : " are ") + says;
}

}  // namespace

const v1::SteadinessDecision* kept_decision(const v1::TrialRecord& trial) noexcept {
  return trial.outcome() == "done" && trial.sway().has_decision() ? &trial.sway().decision() : nullptr;
}

std::string decision_text(const v1::SteadinessDecision& decision) {
  const std::string none = "no decision: ";
  switch (decision.outcome()) {
    case v1::DECISION_OUTCOME_DECIDED: {
      const auto found = std::ranges::find(decision.probabilities(), decision.group(), &v1::GroupProbability::group);
      const bool is_found = found != decision.probabilities().end();
      return "like " + decision.group() + (is_found ? ", p " + fixed(found->probability(), 2) : "");
    }
    case v1::DECISION_OUTCOME_OUTSIDE: return none + named(decision.outside(), "outside of the training");
    case v1::DECISION_OUTCOME_NOT_VALID: return none + "the trial is not valid (stepped off or moved the feet)";
    case v1::DECISION_OUTCOME_MISSING: return none + named(decision.missing(), "missing");
    case v1::DECISION_OUTCOME_NOT_COMPARABLE: return none + "the trial has another rate, filter or duration than the training";
    default: return none + "unknown reason";
  }
}

std::vector<std::string> decision_limits(const v1::SteadinessDecision& decision) {
  std::vector<std::string> limits;
  limits.push_back(decision.label() + ": trained on " + std::to_string(decision.people()) + " people" +
                   (decision.condition().empty() ? "" : " (" + decision.condition() + ")") +
                   "; AUC in people left out of it: " + fixed(decision.auc(), 2) + " (" + fixed(decision.auc_low(), 2) + ".." +
                   fixed(decision.auc_high(), 2) + "; 0.50 is chance).");
  limits.push_back(std::string(decision.is_better_than_one_measure() ? "Better than" : "No better than") + " one measure, " +
                   decision.best_measure() + " (" + fixed(decision.best_measure_auc(), 2) + ").");
  if (decision.has_rival_auc() && !decision.is_better_than_rival())
    limits.push_back(decision.rival() + " does as well without a plate (" + fixed(decision.rival_auc(), 2) + ").");
  if (!decision.about().empty()) limits.push_back(decision.about() + ".");
  limits.emplace_back(kDecisionLimit);
  return limits;
}

}  // namespace dts::report
