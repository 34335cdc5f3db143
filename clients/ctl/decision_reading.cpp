// SPDX-License-Identifier: Apache-2.0
#include "ctl/decision_reading.h"

#include <algorithm>
#include <vector>

#include "cli/table.h"

namespace dts::ctl {
namespace {

std::string named(const google::protobuf::RepeatedPtrField<std::string>& symbols, const std::string& says) {
  const std::vector<std::string> names(symbols.begin(), symbols.end());
  return cli::join(names, ", ") + (names.size() == 1 ? " is " : " are ") + says;
}

}  // namespace

std::string decision_text(const v1::SteadinessDecision& decision) {
  const std::string none = "no decision: ";
  switch (decision.outcome()) {
    case v1::DECISION_OUTCOME_DECIDED: {
      const auto found = std::ranges::find(decision.probabilities(), decision.group(), &v1::GroupProbability::group);
      const bool is_found = found != decision.probabilities().end();
      return "like " + decision.group() + (is_found ? ", p " + cli::decimal(found->probability(), 2) : "");
    }
    case v1::DECISION_OUTCOME_OUTSIDE: return none + named(decision.outside(), "outside of the training");
    case v1::DECISION_OUTCOME_NOT_VALID: return none + "the trial is not valid (stepped off or moved the feet)";
    case v1::DECISION_OUTCOME_MISSING: return none + named(decision.missing(), "missing");
    case v1::DECISION_OUTCOME_NOT_COMPARABLE: return none + "the trial has another rate, filter or duration than the training";
    default: return none + "unknown reason";
  }
}

std::string decision_limits(const v1::SteadinessDecision& decision) {
  std::string text = decision.label() + ": trained on " + std::to_string(decision.people()) + " people";
  if (!decision.condition().empty()) text += " (" + decision.condition() + ")";
  text += "; AUC in people left out of it: " + cli::decimal(decision.auc(), 2) + " (" + cli::decimal(decision.auc_low(), 2) + ".." +
          cli::decimal(decision.auc_high(), 2) + "; 0.50 is chance). ";
  text += std::string(decision.is_better_than_one_measure() ? "Better than" : "No better than") + " one measure, " +
          decision.best_measure() + " (" + cli::decimal(decision.best_measure_auc(), 2) + ").";
  if (decision.has_rival_auc() && !decision.is_better_than_rival())
    text += " " + decision.rival() + " does as well without a plate (" + cli::decimal(decision.rival_auc(), 2) + ").";
  if (!decision.about().empty()) text += " " + decision.about() + ".";
  return text + " It says whose sway this resembles, and nothing about health.";
}

}  // namespace dts::ctl
