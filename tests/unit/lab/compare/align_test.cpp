// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lab/compare/compare.h"
#include "lab/compare/event_match.h"
#include "unit/lab/compare/made_recordings.h"

namespace dts::lab::compare {
namespace {

using ::testing::HasSubstr;

TEST(Align, Triggers_AlignEvenWhatDoesNotLookAlike) {
  const Clock clock_a{.length_s = 30.0};
  const Clock clock_b{.first_s = 50.0, .offset_s = -47.25, .drift_ppm = 300.0, .rate_hz = 1000.0, .length_s = 24.0};
  Recording a = recorded(clock_a);
  Recording b = recorded(clock_b);
  for (double& x : b.x_mm) x = -x;
  for (double& y : b.y_mm) y = 0.0;
  add_triggers(a, clock_a, {1.0, 5.0, 11.0, 22.0});  // the first one is before B begins
  add_triggers(b, clock_b, {1.0, 5.0, 11.0, 22.0});

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::Trigger);
  EXPECT_EQ(alignment->event_count, 3U);
  EXPECT_LT(std::abs(alignment->offset_s - offset_at(clock_b, alignment->reference_s)), 4.0 * alignment->offset_sd_s);
  EXPECT_LT(std::abs(alignment->drift_ppm - 300.0), 4.0 * alignment->drift_sd_ppm);
}

// Long enough for 0.4 s to be within any tolerance in parts of the distance.
TEST(Align, OneExtraTrigger_LeavesTheOthersAsTheyAre) {
  const Clock clock{.rate_hz = 40.0, .length_s = 720.0};
  std::vector<double> at_s{10.0, 110.0, 205.0, 310.0, 420.0, 500.0, 610.0, 700.0};
  Recording a = recorded(clock);
  Recording b = a;
  add_triggers(a, clock, at_s);
  at_s.push_back(700.4);
  add_triggers(b, clock, at_s);

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->means, Alignment::Means::Trigger);
  EXPECT_EQ(alignment->event_count, 8U);
  EXPECT_NEAR(alignment->offset_s, 0.0, 1e-9);
  EXPECT_NEAR(alignment->drift_ppm, 0.0, 1e-3);
}

TEST(Align, UnrelatedTriggers_AreLeftToTheCorrelationWithAWarning) {
  Recording a = recorded({.length_s = 60.0});
  Recording b = recorded({.offset_s = 2.0, .length_s = 58.0});
  add_triggers(a, {}, {5.0, 17.0, 40.3});
  add_triggers(b, {}, {9.0, 30.0, 52.7});

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::Correlation);
  EXPECT_EQ(alignment->event_count, 0U);
  EXPECT_NEAR(alignment->offset_s, 2.0, 1e-3);
  EXPECT_THAT(alignment->warning, HasSubstr("only 1 of 3 and 3 trigger events matches"));

  for (double& x : b.x_mm) x = 0.0;
  for (double& y : b.y_mm) y = 0.0;
  b.y_mm[30] = 1.0;
  const auto nothing = align(a, b);
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().what, HasSubstr("only 1 of 3 and 3 trigger events matches"));
}

TEST(Align, ThousandsOfTriggersThatAreNoPulseTrain_AreNotUsed) {
  Recording a = recorded({.length_s = 60.0});
  Recording b = recorded({.offset_s = 2.0, .length_s = 58.0});
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> at_s(0.0, 58.0);
  for (Recording* recording : {&a, &b}) {
    for (int k = 0; k < 2000; ++k) recording->edges_s.push_back(at_s(random));
    std::ranges::sort(recording->edges_s);
    recording->edge_step_s = 0.01;
  }

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::Correlation);
  EXPECT_NEAR(alignment->offset_s, 2.0, 1e-3);
  EXPECT_THAT(alignment->warning, HasSubstr("more than 500 triggers"));
}

TEST(Align, MissedFirstPulse_TheSignalsTellWhichOneIsLeft) {
  const Clock clock_b{.offset_s = 1.0, .rate_hz = 80.0, .length_s = 23.0};
  Recording a = recorded({});
  Recording b = recorded(clock_b);
  add_triggers(a, {}, {4.0, 18.0});
  add_triggers(b, clock_b, {18.0});

  const auto comparison = compare(a, b);

  ASSERT_TRUE(comparison) << comparison.error().what;
  EXPECT_EQ(comparison->alignment.means, Alignment::Means::Trigger);
  EXPECT_EQ(comparison->alignment.event_count, 1U);
  EXPECT_NEAR(comparison->alignment.offset_s, 1.0, 0.0125);
  EXPECT_GT(comparison->correlation, 0.9);
}

TEST(Align, OneTriggerOnUnlikeSignals_IsNotBelieved) {
  Recording a = recorded({});
  Recording b = a;
  add_triggers(a, {}, {4.0});
  add_triggers(b, {}, {15.0});

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->means, Alignment::Means::Correlation);
  EXPECT_NEAR(alignment->offset_s, 0.0, 1e-6);
  EXPECT_THAT(alignment->warning, HasSubstr("but the recordings differ at these times"));
}

TEST(Align, RegularPulses_FitInManyWaysAndTheSignalsDecide) {
  const Clock clock_b{.offset_s = 2.0, .length_s = 23.0};
  std::vector<double> every_two_s;
  for (int k = 0; k < 12; ++k) every_two_s.push_back(1.0 + 2.0 * k);
  Recording a = recorded({.length_s = 21.5});
  Recording b = recorded(clock_b);
  add_triggers(a, {}, every_two_s);
  add_triggers(b, clock_b, every_two_s);

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::PulseTrain);
  EXPECT_NEAR(alignment->offset_s, 2.0, 0.01);
  EXPECT_EQ(alignment->event_count, 10U);
  EXPECT_THAT(alignment->faults, testing::IsEmpty());
}

TEST(MatchEvents, ManyEventsWithGapsAndDrift_OffsetDriftAndDeviationAreRight) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> apart_s(0.5, 6.0);
  std::normal_distribution<double> late_s(0.0, 0.02);
  Events events{.a_s = {}, .b_s = {}, .sd_s = 0.004};
  double t_s = 100.0;
  for (int k = 0; k < 500; ++k) {
    t_s += apart_s(random);
    if (k % 7 != 0) events.a_s.push_back(t_s);
    if (k % 9 != 0) events.b_s.push_back((t_s - 50.0) / (1.0 + 100e-6) + late_s(random));
  }

  const EventMatch match = match_events(events);

  EXPECT_FALSE(match.is_ambiguous);
  EXPECT_GT(match.alignment.event_count, 250U);
  EXPECT_NEAR(match.alignment.drift_ppm, 100.0, 4.0 * match.alignment.drift_sd_ppm);
  EXPECT_NEAR(match.alignment.to_a_s(1000.0), 1000.0 * (1.0 + 100e-6) + 50.0, 4.0 * match.alignment.offset_sd_s);
  EXPECT_GT(match.alignment.offset_sd_s, events.sd_s / std::sqrt(static_cast<double>(match.alignment.event_count)))
      << "the events themselves scatter by more than scans round them";
}

TEST(MatchEvents, NoEventIsMatchedTwice) {
  const EventMatch match = match_events({.a_s = {1.0, 5.0}, .b_s = {0.99, 1.0, 1.01, 5.0}, .sd_s = 0.004});

  EXPECT_EQ(match.alignment.event_count, 2U);
  EXPECT_NEAR(match.alignment.offset_s, 0.0, 1e-12);
}

TEST(Align, Markers_AlignByEqualText) {
  Recording a = recorded({});
  Recording b = recorded({.offset_s = 1.0});
  a.marker.resize(a.t_s.size());
  b.marker.resize(b.t_s.size());
  a.marker[300] = "start";
  a.marker[500] = "only here";
  a.marker[2000] = "stop";
  b.marker[200] = "start";
  b.marker[1900] = "stop";

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->means, Alignment::Means::Marker);
  EXPECT_EQ(alignment->event_count, 2U);
  EXPECT_NEAR(alignment->offset_s, 1.0, 1e-9);
  EXPECT_NEAR(alignment->drift_ppm, 0.0, 1e-6);
}

}  // namespace
}  // namespace dts::lab::compare
