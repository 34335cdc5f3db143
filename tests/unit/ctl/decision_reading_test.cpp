// SPDX-License-Identifier: Apache-2.0
// Where dtsctl prints the decision of a steadiness model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ctl/session_csv.h"
#include "ctl/sway_reading.h"
#include "dts/v1/sessions.pb.h"
#include "report/decision_words.h"
#include "unit/report/made_decision.h"

namespace dts::ctl {
namespace {

using report::made_decision;
using ::testing::HasSubstr;
using ::testing::Not;

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
  v1::TrialRecord& trial = *session.add_trials();
  trial.set_outcome("done");
  v1::Sway& sway = *trial.mutable_sway();
  *sway.mutable_decision() = made_decision();
  sway.mutable_decision()->mutable_probabilities(0)->set_probability(1.0 / 3.0);
  EXPECT_THAT(trials_csv(session),
              HasSubstr("p_60plus,\"Probability of 60plus by the steadiness model of group60 (like under60, p 0.83). group60: trained"));
  EXPECT_THAT(trials_csv(session), HasSubstr(std::string(report::kDecisionLimit) + "\",0.3333333333333333,1\n"));

  sway.mutable_decision()->set_outcome(v1::DECISION_OUTCOME_OUTSIDE);
  EXPECT_THAT(trials_csv(session), Not(HasSubstr("p_60plus"))) << "a trial without a decision has no probability";
}

TEST(DecisionReading, WithdrawnTrial_HasNoDecision) {
  v1::SessionRecord session;
  v1::TrialRecord& trial = *session.add_trials();
  *trial.mutable_sway()->mutable_decision() = made_decision();
  for (const char* outcome : {"redone", "rejected", "aborted"}) {
    trial.set_outcome(outcome);
    EXPECT_EQ(report::kept_decision(trial), nullptr) << outcome;
    EXPECT_THAT(trials_csv(session), Not(HasSubstr("under60"))) << outcome;
  }
}

}  // namespace
}  // namespace dts::ctl
