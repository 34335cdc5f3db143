// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/pulse_train.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lab/compare/clock_fit.h"
#include "lab/compare/paired.h"
#include "unit/lab/compare/made_recordings.h"

namespace dts::lab::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kHalfAnHourS = 1800.0;

/// One pulse per second, up to 50 ms late, as the daemon sends them.
std::vector<double> pulses(double from_s, double to_s) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> late_s(0.0, 0.05);
  std::vector<double> at_s;
  for (double t_s = from_s; t_s < to_s; t_s += 1.0) at_s.push_back(t_s + late_s(random));
  return at_s;
}

Recording with_pulses(const Clock& clock, const std::vector<double>& at_s, double noise_mm = 0.0) {
  Recording recording = recorded(clock, noise_mm);
  add_triggers(recording, clock, at_s);
  return recording;
}

/// A's clock is true time; B's is 100 ppm slow.
const Clock kClockA{.length_s = kHalfAnHourS};
const Clock kClockB{.offset_s = 3.217, .drift_ppm = 100.0, .length_s = kHalfAnHourS - 5.0};

double error_at_s(const Alignment& alignment, const Clock& clock_b, double t_b_s) {
  return alignment.to_a_s(t_b_s) - clock_b.true_s(t_b_s);
}

TEST(PulseTrain, HalfAnHourAt100Ppm_IsRightToAMillisecondAtTheEnd) {
  RecordProperty("requirement", "LAB-4");
  const auto at_s = pulses(0.5, kHalfAnHourS);

  const auto alignment = align(with_pulses(kClockA, at_s), with_pulses(kClockB, at_s));

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::PulseTrain);
  EXPECT_GT(alignment->event_count, 1780U);
  EXPECT_NEAR(alignment->period_s, 1.0, 0.01);
  const double end_s = kClockB.length_s;
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, end_s)), 1e-3);
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, 0.0)), 1e-3);
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, end_s)), 4.0 * alignment->sd_at_s(end_s));
  EXPECT_LT(alignment->sd_at_s(end_s), 1e-3);
  EXPECT_LT(std::abs(alignment->drift_ppm - 100.0), 4.0 * alignment->drift_sd_ppm);
  EXPECT_THAT(alignment->faults, IsEmpty());
}

TEST(Correlation, HalfAnHourAt100Ppm_IsRightToThreeMillisecondsAtTheEnd) {
  const Recording a = recorded(kClockA, 0.2);

  const auto alignment = align(a, recorded(kClockB, 0.3));

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::Correlation);
  EXPECT_EQ(alignment->window_count, 60U);
  const double end_s = kClockB.length_s;
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, end_s)), 3e-3);
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, end_s)), 4.0 * alignment->sd_at_s(end_s));
  EXPECT_LT(std::abs(alignment->drift_ppm - 100.0), 4.0 * alignment->drift_sd_ppm);
}

TEST(PulseTrain, LostAndExtraPulses_AreReportedWithTheirTimes) {
  const auto at_s = pulses(0.5, 120.0);
  auto of_a = at_s;
  auto of_b = at_s;
  of_b.erase(of_b.begin() + 40);
  of_a.erase(of_a.begin() + 70);
  of_a.insert(of_a.begin() + 20, at_s[19] + 0.4);
  const Clock clock_a{.length_s = 120.0};
  const Clock clock_b{.offset_s = 3.217, .drift_ppm = 100.0, .length_s = 110.0};

  const auto alignment = align(with_pulses(clock_a, of_a), with_pulses(clock_b, of_b));

  ASSERT_TRUE(alignment) << alignment.error().what;
  ASSERT_EQ(alignment->faults.size(), 3U);
  EXPECT_EQ(alignment->faults[0].kind, PulseFault::Kind::ExtraInA);
  EXPECT_NEAR(alignment->faults[0].time_s, at_s[19] + 0.4, 0.02);
  EXPECT_EQ(alignment->faults[1].kind, PulseFault::Kind::LostInB);
  EXPECT_NEAR(alignment->faults[1].time_s, at_s[40], 0.02);
  EXPECT_EQ(alignment->faults[2].kind, PulseFault::Kind::LostInA);
  EXPECT_NEAR(alignment->faults[2].time_s, at_s[70], 0.02);
  EXPECT_LT(std::abs(error_at_s(*alignment, clock_b, 110.0)), 3e-3);
}

/// Removes a stretch of a recording, and lets its clock jump there.
void restart(Recording& recording, double from_s, double to_s, double jump_s) {
  Recording cut = recording;
  cut.t_s.clear();
  cut.x_mm.clear();
  cut.y_mm.clear();
  cut.edges_s.clear();
  for (std::size_t k = 0; k < recording.t_s.size(); ++k) {
    const double t_s = recording.t_s[k];
    if (t_s >= from_s && t_s < to_s) continue;
    cut.t_s.push_back(t_s < from_s ? t_s : t_s + jump_s);
    cut.x_mm.push_back(recording.x_mm[k]);
    cut.y_mm.push_back(recording.y_mm[k]);
  }
  for (const double edge_s : recording.edges_s) {
    if (edge_s < from_s || edge_s > to_s) cut.edges_s.push_back(edge_s < from_s ? edge_s : edge_s + jump_s);
  }
  cut.restarts_s.push_back(to_s + jump_s);
  recording = cut;
}

void expect_aligned_about_the_restarts(const Recording& a, const Recording& b, const Clock& clock_b, double tolerance_s) {
  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  ASSERT_EQ(alignment->pieces.size(), 3U);
  EXPECT_THAT(alignment->faults, IsEmpty()) << "the pulses in the gap were not lost one by one";
  EXPECT_NEAR(alignment->to_a_s(10.0), clock_b.true_s(10.0), tolerance_s);
  EXPECT_NEAR(alignment->to_a_s(390.0), clock_b.true_s(390.0), tolerance_s) << "before the gap of B";
  EXPECT_NEAR(alignment->to_a_s(500.12), clock_b.true_s(500.0), tolerance_s) << "after it";
  EXPECT_NEAR(alignment->to_a_s(880.12), clock_b.true_s(880.0) - 0.07, tolerance_s) << "after the gap of A";
  EXPECT_LT(std::abs(alignment->drift_ppm - 100.0), 4.0 * alignment->drift_sd_ppm);
  EXPECT_LT(alignment->drift_sd_ppm, 5.0);
  const Paired paired = pair_up(a, b, *alignment);
  EXPECT_GT(paired.t_a_s.size(), 75'000U);
  EXPECT_GT(correlation(paired), 0.99);
}

TEST(PulseTrain, GapsAtWhichTheClocksJump_EachPieceHasItsOwnOffset) {
  const Clock clock_a{.length_s = 900.0};
  const Clock clock_b{.offset_s = 3.217, .drift_ppm = 100.0, .length_s = 890.0};
  const auto at_s = pulses(0.5, 900.0);
  Recording a = with_pulses(clock_a, at_s);
  Recording b = with_pulses(clock_b, at_s);
  restart(a, 650.0, 660.0, -0.07);
  restart(b, 400.0, 460.0, 0.12);

  expect_aligned_about_the_restarts(a, b, clock_b, 2e-3);

  a.edges_s.clear();
  b.edges_s.clear();
  expect_aligned_about_the_restarts(a, b, clock_b, 5e-3);
}

TEST(PulseTrain, AJumpOfMoreThanAQuarterPeriodAtAGap_DoesNotShiftThePulsesByAPeriod) {
  const Clock clock_a{.length_s = 410.0};
  const Clock clock_b{.offset_s = 3.217, .length_s = 400.0};
  const auto at_s = pulses(0.5, 410.0);
  for (const double jump_s : {0.9034, -3.0566, 5.1234, 0.4}) {
    const Recording a = with_pulses(clock_a, at_s, 0.2);
    Recording b = with_pulses(clock_b, at_s, 0.3);
    restart(b, 330.0, 340.0, jump_s);
    if (jump_s == 0.4) b.restarts_s.clear();  // on the grid: only the pulses show it

    const auto alignment = align(a, b);

    ASSERT_TRUE(alignment) << alignment.error().what;
    ASSERT_EQ(alignment->pieces.size(), 2U) << jump_s;
    EXPECT_NEAR(alignment->to_a_s(100.0), clock_b.true_s(100.0), 3e-3) << jump_s;
    EXPECT_NEAR(alignment->to_a_s(380.0 + jump_s), clock_b.true_s(380.0), 3e-3) << jump_s;
    EXPECT_THAT(alignment->faults, IsEmpty()) << jump_s;
  }
}

TEST(ClockFit, TheErrorOfAPiece_HasThoseOfItsReferenceAndOfTheDriftBetweenBoth) {
  const Recording a{.t_s = {}, .x_mm = {}, .y_mm = {}};
  Recording b = a;
  b.restarts_s = {350.0};
  std::vector<ClockReading> readings;
  for (int k = 0; k < 400; ++k) {
    if (k < 300 || k >= 380) readings.push_back({.b_s = k + 0.5, .late_s = k < 300 ? 1.0 : 1.1, .sd_s = 0.01});
  }

  const auto alignment = fit_clocks(readings, Restarts(a, b));

  ASSERT_TRUE(alignment);
  ASSERT_EQ(alignment->pieces.size(), 2U);
  EXPECT_EQ(alignment->pieces[0].shift_sd_s, 0.0);
  const double of_small_s = 0.01 / std::sqrt(20.0);
  const double of_large_s = 0.01 / std::sqrt(300.0);
  const double by_drift_s = 1e-6 * alignment->drift_sd_ppm * (390.0 - 150.0);
  EXPECT_NEAR(alignment->pieces[1].shift_sd_s, std::hypot(of_small_s, of_large_s, by_drift_s), 1e-9);
  EXPECT_NEAR(alignment->sd_at_s(390.0), of_small_s, 1e-9) << "in the middle of the piece only its own error counts";
  EXPECT_NEAR(alignment->sd_at_s(150.0), of_large_s, 1e-9);
}

TEST(PulseTrain, NothingShowsWhichPulsesBelongTogetherAfterAGap_ThatPieceIsUnknown) {
  const Clock clock_a{.length_s = 410.0};
  const Clock clock_b{.offset_s = 3.217, .length_s = 400.0};
  const auto at_s = pulses(0.5, 410.0);
  const Recording a = with_pulses(clock_a, at_s, 0.2);
  Recording b = with_pulses(clock_b, at_s, 0.3);
  restart(b, 330.0, 340.0, 0.9034);
  for (std::size_t k = 0; k < b.t_s.size(); ++k) {
    if (b.t_s[k] > 335.0) b.x_mm[k] = b.y_mm[k] = static_cast<double>(k % 7);
  }

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_NEAR(alignment->to_a_s(100.0), clock_b.true_s(100.0), 3e-3);
  EXPECT_TRUE(std::isnan(alignment->to_a_s(380.0)));
  EXPECT_TRUE(std::isnan(alignment->sd_at_s(380.0)));
}

TEST(PulseTrain, AFewSecondsOfPulsesInALongRecording_TheSignalsGiveTheDrift) {
  const Clock clock_b{.offset_s = 3.217, .length_s = 300.0};
  const auto at_s = pulses(4.0, 16.0);

  const auto alignment = align(with_pulses({.length_s = 310.0}, at_s, 0.2), with_pulses(clock_b, at_s, 0.3));

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::PulseTrain);
  EXPECT_TRUE(alignment->is_drift_by_signals);
  EXPECT_LT(std::abs(error_at_s(*alignment, clock_b, 295.0)), 0.01);
}

TEST(PulseTrain, WholePeriodsAreOpen_UnlessOneComputerOrTheSignalsDecide) {
  const auto at_s = pulses(0.5, 60.0);
  const Clock clock_b{.offset_s = 7.3, .length_s = 50.0};
  Recording a = with_pulses({.length_s = 60.0}, at_s);
  Recording b = with_pulses(clock_b, at_s);
  for (std::size_t k = 0; k < b.t_s.size(); ++k) b.x_mm[k] = b.y_mm[k] = static_cast<double>(k % 7);

  const auto open = align(a, b);
  ASSERT_FALSE(open);
  EXPECT_THAT(open.error().what, HasSubstr("nothing shows which of them belong together"));

  a.host_clock = b.host_clock = "one computer";
  a.began_s = 5000.0;
  b.began_s = 5007.31;
  const auto alignment = align(a, b);
  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_NEAR(alignment->offset_s, 7.3, 0.01);

  b.host_clock = "another computer";
  EXPECT_FALSE(align(a, b));

  a.marker.resize(a.t_s.size());
  b.marker.resize(b.t_s.size());
  a.marker[2000] = b.marker[1270] = "start";
  a.marker[4000] = b.marker[3270] = "end";
  const auto by_marker = align(a, b);
  ASSERT_TRUE(by_marker) << by_marker.error().what;
  EXPECT_EQ(by_marker->means, Alignment::Means::PulseTrain);
  EXPECT_NEAR(by_marker->offset_s, 7.3, 0.01);
}

TEST(PulseTrain, AConstantErrorOfTheTimesIsNotBelieved_IfTheSignalsContradict) {
  const auto at_s = pulses(0.5, 60.0);
  const Clock clock_b{.offset_s = 7.3, .length_s = 50.0};
  Recording a = with_pulses({.length_s = 60.0}, at_s);
  Recording b = with_pulses(clock_b, at_s);
  a.host_clock = b.host_clock = "one computer";
  a.began_s = 5000.0;
  b.began_s = 5007.3 - 3.0;

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::PulseTrain);
  EXPECT_NEAR(alignment->offset_s, 7.3, 0.01);
  EXPECT_THAT(alignment->warning, HasSubstr("the signals contradict the times of the recordings"));
}

/// Pulses in step with A's clock, just after a scan: A rounds all of them by nearly a whole scan.
std::vector<double> pulses_in_step(double to_s) {
  std::vector<double> at_s;
  for (double t_s = 1.0; t_s < to_s; t_s += 1.0) at_s.push_back(t_s + 1e-6);
  return at_s;
}

TEST(PulseTrain, PulsesOfARecordingsOwnClockAreRoundedAlike_AndManyOfThemAreNoBetterThanOne) {
  for (const double drift_ppm : {0.0, 100.0}) {
    const Clock clock_b{.offset_s = 0.0043, .drift_ppm = drift_ppm, .length_s = 600.0};
    Recording a = with_pulses({.length_s = 600.0}, pulses_in_step(600.0));
    Recording b = with_pulses(clock_b, pulses_in_step(600.0));
    for (std::size_t k = 0; k < b.t_s.size(); ++k) b.x_mm[k] = b.y_mm[k] = static_cast<double>(k % 7);
    a.host_clock = b.host_clock = "one computer";

    const auto alignment = align(a, b);

    ASSERT_TRUE(alignment) << alignment.error().what;
    EXPECT_GT(alignment->offset_sd_s, 0.0028);
    EXPECT_LT(std::abs(error_at_s(*alignment, clock_b, 30.0)), 3.0 * alignment->offset_sd_s);
  }
}

TEST(PulseTrain, PulsesRoundedAlike_TheSignalsGiveTheOffsetWithinTheScanAndNoMore) {
  const auto at_s = pulses_in_step(kHalfAnHourS);
  Recording a = with_pulses(kClockA, at_s, 0.2);
  const Recording b = with_pulses(kClockB, at_s, 0.3);
  const double end_s = kClockB.length_s;

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_EQ(alignment->means, Alignment::Means::PulseTrain);
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, end_s)), 1e-3);
  EXPECT_LT(std::abs(error_at_s(*alignment, kClockB, end_s)), 4.0 * alignment->sd_at_s(end_s));

  const double delay_s = 0.1;  // of an unknown filter
  for (double& t_s : a.t_s) t_s += delay_s;
  const auto misled = align(a, b);
  ASSERT_TRUE(misled) << misled.error().what;
  EXPECT_LT(std::abs(error_at_s(*misled, kClockB, end_s)), 0.011);
  EXPECT_GT(misled->offset_sd_s, 0.0028);
}

/// The pulses as an analogue signal that needs 30 ms to rise, centred on the edge.
std::vector<double> ramps(const Recording& recording, const Clock& clock, const std::vector<double>& at_s) {
  std::vector<double> level;
  for (const double t_s : recording.t_s) {
    const double now_s = clock.true_s(t_s);
    const auto next = std::ranges::upper_bound(at_s, now_s + 0.015);
    const double since_s = next == at_s.begin() ? 1.0 : now_s - *(next - 1) + 0.015;
    level.push_back(since_s > 0.1 ? 0.0 : 5.0 * std::min(1.0, since_s / 0.03));
  }
  return level;
}

TEST(PulseTrain, PulsesThatRiseSlowly_AreKnownBetterThanToAScan) {
  std::vector<double> at_s;
  for (int k = 0; k < 600; ++k) at_s.push_back(1.0 + k + 0.0021);
  const Clock clock_a{.length_s = 600.0};
  const Clock clock_b{.offset_s = 3.217, .drift_ppm = 100.0, .length_s = 590.0};
  Recording a = recorded(clock_a);
  Recording b = recorded(clock_b);
  for (const auto& [recording, clock] : {std::pair{&a, &clock_a}, std::pair{&b, &clock_b}}) {
    const RisingEdges edges = rising_edges(recording->t_s, ramps(*recording, *clock, at_s));
    recording->edges_s = edges.at_s;
    recording->edge_step_s = edges.step_s;
  }

  const auto alignment = align(a, b);

  ASSERT_TRUE(alignment) << alignment.error().what;
  EXPECT_LT(std::abs(error_at_s(*alignment, clock_b, 590.0)), 0.2e-3);
  EXPECT_LT(alignment->sd_at_s(590.0), 0.5e-3);
}

TEST(RisingEdges, AreInterpolated_AndTheLevelMustFallBeforeTheNext) {
  const std::vector<double> t_s{0.0, 1.0, 2.0, 3.0, 4.0, 5.0};
  const double none = std::nan("");

  const RisingEdges hard = rising_edges(t_s, std::vector{0.0, 0.0, 5.0, none, 0.0, 5.0});
  EXPECT_THAT(hard.at_s, testing::ElementsAre(1.5, 4.5));
  EXPECT_EQ(hard.step_s, 1.0);

  const RisingEdges soft = rising_edges(t_s, std::vector{0.0, 1.0, 3.5, 2.0, 4.0, 5.0});
  EXPECT_THAT(soft.at_s, testing::ElementsAre(testing::DoubleEq(1.6))) << "the level did not fall far enough for a second edge";
  EXPECT_DOUBLE_EQ(soft.step_s, 0.1);

  const RisingEdges given = rising_edges(t_s, std::vector{0.0, 1.0, 2.2, 2.9, 0.0, 4.0}, TriggerLevel{.level = 2.5, .band = 1.0});
  EXPECT_THAT(given.at_s, testing::ElementsAre(testing::DoubleEq(4.625))) << "2.9 is within the band";

  EXPECT_THAT(rising_edges(t_s, std::vector(6, 1.0)).at_s, IsEmpty());
  EXPECT_THAT(rising_edges(t_s, {}).at_s, IsEmpty());
}

TEST(RisingEdges, OneSpikeAmongPulsesDoesNotLoseThem_AndIdleNoiseHasNone) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise_v(0.0, 0.05);
  std::vector<double> t_s;
  std::vector<double> pulses_v;
  std::vector<double> rare_v;
  std::vector<double> idle_v;
  std::vector<double> small_v;
  for (int k = 0; k < 12'000; ++k) {
    t_s.push_back(0.01 * k);
    pulses_v.push_back(k == 5555 ? 10.0 : (k % 100 < 5 && k > 20 ? 5.0 : 0.0) + noise_v(random));
    rare_v.push_back((k > 6000 && k < 6005 ? 5.0 : 0.0) + noise_v(random));
    idle_v.push_back(3.0 * noise_v(random));
    small_v.push_back(k % 3 == 0 ? 0.0003 : 0.0);
  }

  EXPECT_THAT(rising_edges(t_s, pulses_v).at_s, testing::SizeIs(119 + 1)) << "the pulses and the spike";
  EXPECT_THAT(rising_edges(t_s, rare_v).at_s, testing::SizeIs(1));
  EXPECT_THAT(rising_edges(t_s, idle_v).at_s, IsEmpty());
  EXPECT_THAT(rising_edges(t_s, small_v).at_s, IsEmpty()) << "one step of the converter";
}

TEST(RisingEdges, ARiseWithinAGapIsNoEdge) {
  std::vector<double> t_s;
  std::vector<double> level;
  for (int k = 0; k < 40; ++k) {
    t_s.push_back(k < 20 ? 0.01 * k : 0.01 * k + 10.0);
    level.push_back(k >= 20 && k < 25 ? 5.0 : (k >= 30 ? 5.0 : 0.0));
  }

  EXPECT_THAT(rising_edges(t_s, level).at_s, testing::ElementsAre(testing::DoubleNear(10.295, 1e-9)));
}

TEST(PulseTrain, PulsesInStepWithARecordingWhileTheClocksDriftByLessThanAScan_HaveHonestErrors) {
  for (const double length_s : {60.0, 240.0}) {
    for (const double drift_ppm : {30.0, 100.0}) {
      for (const double phase_s : {0.0005, 0.0045, 0.0085}) {
        const Clock clock_b{.offset_s = phase_s, .drift_ppm = drift_ppm, .length_s = length_s - 1.0};
        const auto at_s = pulses_in_step(length_s);

        const auto alignment = align(with_pulses({.length_s = length_s}, at_s, 0.2), with_pulses(clock_b, at_s, 0.3));

        ASSERT_TRUE(alignment) << alignment.error().what;
        const double end_s = clock_b.length_s;
        EXPECT_LT(std::abs(alignment->drift_ppm - drift_ppm), 4.0 * alignment->drift_sd_ppm) << length_s << ' ' << phase_s;
        EXPECT_LT(std::abs(error_at_s(*alignment, clock_b, end_s)), 4.0 * alignment->sd_at_s(end_s)) << length_s << ' ' << phase_s;
      }
    }
  }
}

}  // namespace
}  // namespace dts::lab::compare
