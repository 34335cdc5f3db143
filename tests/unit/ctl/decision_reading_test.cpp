// SPDX-License-Identifier: Apache-2.0
#include "ctl/decision_reading.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ctl/session_csv.h"
#include "ctl/sway_reading.h"
#include "dts/v1/sessions.pb.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

v1::SteadinessDecision made_decision() {
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

TEST(DecisionReading, Decision_HasItsOwnProbability) { EXPECT_EQ(decision_text(made_decision()), "like under60, p 0.83"); }

TEST(DecisionReading, WithoutADecision_NoGroupIsNamed) {
  v1::SteadinessDecision decision = made_decision();
  decision.add_outside("MVELO");
  decision.set_outcome(v1::DECISION_OUTCOME_OUTSIDE);
  EXPECT_EQ(decision_text(decision), "no decision: MVELO is outside of the training");
  decision.add_outside("RANGE_AP");
  EXPECT_EQ(decision_text(decision), "no decision: MVELO, RANGE_AP are outside of the training");
  decision.set_outcome(v1::DECISION_OUTCOME_NOT_VALID);
  EXPECT_EQ(decision_text(decision), "no decision: the trial is not valid (stepped off or moved the feet)");
  decision.add_missing("MDIST");
  decision.set_outcome(v1::DECISION_OUTCOME_MISSING);
  EXPECT_EQ(decision_text(decision), "no decision: MDIST is missing");
  decision.set_outcome(v1::DECISION_OUTCOME_NOT_COMPARABLE);
  EXPECT_EQ(decision_text(decision), "no decision: the trial has another rate, filter or duration than the training");
  for (const auto outcome : {v1::DECISION_OUTCOME_NOT_COMPARABLE, v1::DECISION_OUTCOME_UNSPECIFIED}) {
    decision.set_outcome(outcome);
    EXPECT_THAT(decision_text(decision), Not(HasSubstr("under60")));
  }
}

TEST(DecisionReading, Limits_AreComplete) {
  RecordProperty("requirement", "SWAY-10");
  EXPECT_EQ(
      decision_limits(made_decision()),
      "group60: trained on 124 people (condition=ec_firm); AUC in people left out of it: 0.81 (0.73..0.88; 0.50 is chance). No better "
      "than one measure, MVELO (0.78). height_cm with sex does as well without a plate (0.83). nearly nobody of 41 to 59. It says whose "
      "sway this resembles, and nothing about health.");
  v1::SteadinessDecision better = made_decision();
  better.set_is_better_than_one_measure(true);
  better.set_is_better_than_rival(true);
  EXPECT_THAT(decision_limits(better), HasSubstr("Better than one measure, MVELO"));
  EXPECT_THAT(decision_limits(better), Not(HasSubstr("height_cm")));
}

TEST(DecisionReading, Watch_HasTheDecisionWithItsLimits) {
  v1::Sway sway;
  sway.set_trial(3);
  sway.set_is_valid(true);
  EXPECT_THAT(sway_text(sway), Not(HasSubstr("decision")));
  *sway.mutable_decision() = made_decision();
  EXPECT_THAT(sway_text(sway), HasSubstr("  like under60, p 0.83. group60: trained on 124 people"));
}

TEST(DecisionReading, Csv_HasEveryBitOfTheProbabilities) {
  v1::SessionRecord session;
  v1::Sway& sway = *session.add_trials()->mutable_sway();
  *sway.mutable_decision() = made_decision();
  sway.mutable_decision()->mutable_probabilities(0)->set_probability(1.0 / 3.0);
  EXPECT_THAT(trials_csv(session), HasSubstr("p_60plus,\"Probability of 60plus by the steadiness model of group60 (like under60, p 0.83)\","
                                             "0.3333333333333333,1\n"));

  sway.mutable_decision()->set_outcome(v1::DECISION_OUTCOME_OUTSIDE);
  EXPECT_THAT(trials_csv(session), Not(HasSubstr("p_60plus"))) << "a trial without a decision has no probability";
}

}  // namespace
}  // namespace dts::ctl
