// SPDX-License-Identifier: Apache-2.0
#include "report/decision_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/join.h"
#include "made_decision.h"

namespace dts::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(DecisionWords, OnlyATrialThatCounts_HasADecision) {
  v1::TrialRecord trial;
  trial.set_outcome("done");
  EXPECT_EQ(kept_decision(trial), nullptr);
  *trial.mutable_sway()->mutable_decision() = made_decision();
  EXPECT_EQ(kept_decision(trial), &trial.sway().decision());
  trial.set_outcome("redone");
  EXPECT_EQ(kept_decision(trial), nullptr);
}

TEST(DecisionWords, Decision_HasItsOwnProbability) { EXPECT_EQ(decision_text(made_decision()), "like under60, p 0.83"); }

TEST(DecisionWords, WithoutADecision_NoGroupIsNamed) {
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

TEST(DecisionWords, Limits_AreComplete) {
  RecordProperty("requirement", "SWAY-10");
  EXPECT_EQ(
      core::join(decision_limits(made_decision()), " "),
      "group60: trained on 124 people (condition=ec_firm); AUC in people left out of it: 0.81 (0.73..0.88; 0.50 is chance). No better "
      "than one measure, MVELO (0.78). height_cm with sex does as well without a plate (0.83). nearly nobody of 41 to 59. No "
      "statement about health or risk of falling.");
  v1::SteadinessDecision better = made_decision();
  better.set_is_better_than_one_measure(true);
  better.set_is_better_than_rival(true);
  EXPECT_THAT(core::join(decision_limits(better)), HasSubstr("Better than one measure, MVELO"));
  EXPECT_THAT(core::join(decision_limits(better)), Not(HasSubstr("height_cm")));
}

}  // namespace
}  // namespace dts::report
