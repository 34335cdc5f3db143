// SPDX-License-Identifier: Apache-2.0
// Where dtsctl prints the decision of a steadiness model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ctl/session_csv.h"
#include "ctl/sway_reading.h"
#include "dts/v1/sessions.pb.h"
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
