// SPDX-License-Identifier: Apache-2.0
#include "session/steadiness_decision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pattern/decision.h"
#include "record/sha256.h"
#include "session/session_events.h"

namespace dts::session {
namespace {

using posturography::Measure;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

pipeline::SteadinessModel made_steadiness_model() {
  pipeline::SteadinessModel made{.model = {.label = "group60",
                                           .condition = "condition=ec_firm",
                                           .about = "nearly nobody of 41 to 59",
                                           .profile = "lp10",
                                           .rate_hz = 100.0,
                                           .duration_s = 60.0,
                                           .discriminant = {.classes = {"60plus", "under60"},
                                                            .predictors = {{Measure::Mvelo, true, 2.0, 0.25, 3.0, 20.0}},
                                                            .weights = {{0.75}, {-0.75}},
                                                            .offsets = {0.1, -0.1}},
                                           .people = 124,
                                           .groups = {{}, {}},
                                           .verdict = pattern::Verdict::Told},
                                 .text = "{}",
                                 .labels = {}};
  made.model.figures.auc = {.value = 0.81, .low = 0.73, .high = 0.88};
  made.model.figures.best_measure = "MVELO";
  made.model.figures.best_auc = {.value = 0.78, .low = 0.7, .high = 0.85};
  made.model.figures.gain = {.value = 0.03, .low = -0.01, .high = 0.09};
  made.model.figures.rival = "height_cm with sex";
  made.model.figures.rival_auc = {.value = 0.83, .low = 0.75, .high = 0.9};
  return made;
}

SwayTrialResult trial_of(double mvelo, std::uint32_t flags = 0) {
  SwayTrialResult trial{.trial = 1, .condition = "eyes-closed", .labels = {{"eyes", "closed"}, {"feet", "two"}}};
  trial.analysis = posturography::Analysis{.rate_hz = 100.0, .samples = 6000, .duration_s = 60.0, .flags = flags};
  trial.analysis->measures.set(Measure::Mvelo, mvelo);
  return trial;
}

TEST(SteadinessDecider, Decision_IsThatOfTheModelWithItsLimits) {
  const auto model = made_steadiness_model();
  const SwayTrialResult trial = trial_of(11.0);

  const auto message = SteadinessDecider(model).decide(trial);

  ASSERT_TRUE(message);
  const auto expected = pattern::decide(model.model, {.measures = trial.analysis->measures, .profile = "lp10", .rate_hz = 100.0});
  EXPECT_EQ(message->outcome(), v1::DECISION_OUTCOME_DECIDED);
  EXPECT_EQ(message->group(), "60plus");
  ASSERT_EQ(message->probabilities_size(), 2);
  EXPECT_EQ(message->probabilities(0).group(), "60plus");
  EXPECT_EQ(message->probabilities(0).probability(), expected.answer.probabilities[0]) << "every bit";
  EXPECT_EQ(message->label(), "group60");
  EXPECT_EQ(message->people(), 124U);
  EXPECT_EQ(message->condition(), "condition=ec_firm");
  EXPECT_EQ(message->about(), "nearly nobody of 41 to 59");
  EXPECT_EQ(message->auc_low(), 0.73);
  EXPECT_FALSE(message->is_better_than_one_measure()) << "the interval of the gain reaches below 0";
  EXPECT_EQ(message->rival(), "height_cm with sex");
  EXPECT_FALSE(message->is_better_than_rival());
  EXPECT_EQ(message->model_sha256(), record::sha256_of("{}"));
}

TEST(SteadinessDecider, WhatIsNoDecision_SaysWhy) {
  const SteadinessDecider decider(made_steadiness_model());

  const auto outside = decider.decide(trial_of(25.0));
  EXPECT_EQ(outside->outcome(), v1::DECISION_OUTCOME_OUTSIDE);
  EXPECT_THAT(outside->outside(), ElementsAre("MVELO"));
  EXPECT_EQ(decider.decide(trial_of(11.0, posturography::sway_flag::kMoved))->outcome(), v1::DECISION_OUTCOME_NOT_VALID);
  const auto missing = decider.decide(trial_of(0.0));
  EXPECT_EQ(missing->outcome(), v1::DECISION_OUTCOME_MISSING);
  EXPECT_THAT(missing->missing(), ElementsAre("MVELO"));
  EXPECT_THAT(missing->group(), IsEmpty());
  SwayTrialResult other = trial_of(11.0);
  other.analysis->rate_hz = 130.0;
  EXPECT_EQ(decider.decide(other)->outcome(), v1::DECISION_OUTCOME_NOT_COMPARABLE);
  SwayTrialResult shorter = trial_of(11.0);
  shorter.analysis->duration_s = 20.0;
  EXPECT_EQ(decider.decide(shorter)->outcome(), v1::DECISION_OUTCOME_NOT_COMPARABLE);
}

TEST(SteadinessDecider, OtherTrials_HaveNoDecision) {
  auto model = made_steadiness_model();
  model.labels = {{"eyes", "closed"}};
  EXPECT_TRUE(SteadinessDecider(model).decide(trial_of(11.0)));
  model.labels = {{"eyes", "open"}};
  EXPECT_FALSE(SteadinessDecider(model).decide(trial_of(11.0)));
  model.labels = {{"eyes", "closed"}, {"surface", "foam"}};
  EXPECT_FALSE(SteadinessDecider(model).decide(trial_of(11.0))) << "every label must be there";

  SwayTrialResult with_feedback = trial_of(11.0);
  with_feedback.labels.emplace_back(kFeedbackLabel, kCopFeedback);
  EXPECT_FALSE(SteadinessDecider(made_steadiness_model()).decide(with_feedback));

  EXPECT_FALSE(SteadinessDecider(std::nullopt).decide(trial_of(11.0)));
  SwayTrialResult failed{.trial = 1};
  failed.problem = "no samples";
  EXPECT_FALSE(SteadinessDecider(made_steadiness_model()).decide(failed));
}

TEST(SteadinessDecider, Decision_IsReadBackFromTheRecordedEvent) {
  SwayTrialResult trial = trial_of(11.0);
  trial.decision = SteadinessDecider(made_steadiness_model()).decide(trial);

  const auto read = sway_of(to_event(trial, "20261127T000000Z", "dtsd"));

  ASSERT_TRUE(read) << read.error().what;
  ASSERT_TRUE(read->decision);
  EXPECT_EQ(read->decision->SerializeAsString(), trial.decision->SerializeAsString());
}

}  // namespace
}  // namespace dts::session
