// SPDX-License-Identifier: Apache-2.0
#include "session/steadiness_decision.h"

#include <algorithm>

#include "pattern/decision.h"
#include "record/sha256.h"
#include "record/utf8_text.h"
#include "session/protocol.h"

namespace dts::session {
namespace {

using pattern::Outcome;
using record::clean_text;

// The outcomes of the room `pattern` are those of the protocol.
static_assert(static_cast<int>(Outcome::Decided) == v1::DECISION_OUTCOME_DECIDED);
static_assert(static_cast<int>(Outcome::Outside) == v1::DECISION_OUTCOME_OUTSIDE);
static_assert(static_cast<int>(Outcome::NotValid) == v1::DECISION_OUTCOME_NOT_VALID);
static_assert(static_cast<int>(Outcome::Missing) == v1::DECISION_OUTCOME_MISSING);
static_assert(static_cast<int>(Outcome::NotComparable) == v1::DECISION_OUTCOME_NOT_COMPARABLE);

v1::SteadinessDecision facts_of(const pipeline::SteadinessModel& steadiness) {
  const pattern::PatternModel& model = steadiness.model;
  v1::SteadinessDecision facts;
  facts.set_label(clean_text(model.label));
  facts.set_condition(clean_text(model.condition));
  facts.set_people(static_cast<std::uint32_t>(model.people));
  facts.set_about(clean_text(model.about));
  facts.set_auc(model.figures.auc.value);
  facts.set_auc_low(model.figures.auc.low);
  facts.set_auc_high(model.figures.auc.high);
  facts.set_best_measure(model.figures.best_measure);
  facts.set_best_measure_auc(model.figures.best_auc.value);
  facts.set_is_better_than_one_measure(model.figures.gain.low > 0.0);
  if (!model.figures.rival.empty()) {
    facts.set_rival(clean_text(model.figures.rival));
    facts.set_rival_auc(model.figures.rival_auc.value);
    facts.set_is_better_than_rival(model.figures.rival_gain.low > 0.0);
  }
  facts.set_model_sha256(record::sha256_of(steadiness.text));
  return facts;
}

}  // namespace

SteadinessDecider::SteadinessDecider(const std::optional<pipeline::SteadinessModel>& model) : model_(model) {
  if (model_) facts_ = facts_of(*model_);
}

std::optional<v1::SteadinessDecision> SteadinessDecider::decide(const SwayTrialResult& trial) const {
  if (!model_ || !trial.analysis) return std::nullopt;
  const auto has_label = [&](const auto& label) { return std::ranges::find(trial.labels, label) != trial.labels.end(); };
  if (!std::ranges::all_of(model_->labels, has_label)) return std::nullopt;
  // Feedback changes sway, and the people of the training had none.
  if (std::ranges::find(trial.labels, kFeedbackLabel, &std::pair<std::string, std::string>::first) != trial.labels.end())
    return std::nullopt;
  const posturography::Analysis& analysis = *trial.analysis;
  const pattern::Decision decision = pattern::decide(model_->model, {.measures = analysis.measures,
                                                                     .profile = posturography::name(analysis.profile),
                                                                     .rate_hz = analysis.rate_hz,
                                                                     .duration_s = analysis.duration_s,
                                                                     .is_valid = analysis.is_valid()});
  v1::SteadinessDecision message = facts_;
  message.set_outcome(static_cast<v1::DecisionOutcome>(decision.outcome));
  const auto& groups = model_->model.discriminant.classes;
  if (decision.answer.best) message.set_group(clean_text(groups[*decision.answer.best]));
  for (std::size_t k = 0; k < decision.answer.probabilities.size(); ++k) {
    v1::GroupProbability& one = *message.add_probabilities();
    one.set_group(clean_text(groups[k]));
    one.set_probability(decision.answer.probabilities[k]);
  }
  for (const auto measure : decision.answer.outside) message.add_outside(std::string(posturography::info(measure).symbol));
  for (const auto measure : decision.answer.missing) message.add_missing(std::string(posturography::info(measure).symbol));
  return message;
}

}  // namespace dts::session
