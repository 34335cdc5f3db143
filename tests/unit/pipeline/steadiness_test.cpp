// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/steadiness.h"

#include <gmock/gmock.h>

#include <cmath>
#include <iterator>
#include <map>
#include <sstream>

#include "pipeline/pipeline.h"
#include "unit/pipeline/standing_cop.h"

namespace dts::pipeline {
namespace {

/// A prepared stage, at 100 Hz if nothing else is said, and what it told.
class Watching {
 public:
  explicit Watching(std::map<std::string, OptionValue, std::less<>> options = {}, double hz = 100.0) {
    stage_ = surroundings_.make({.id = "steadiness", .options = std::move(options)});
    EXPECT_TRUE(stage_->prepare(swaying_cop(hz, 0, 1).format, 64));
  }

  std::vector<core::SwayEvent> watch(const Signal& signal, std::size_t block = 10) {
    const Output output = run(*stage_, 0, signal, std::span(&block, 1));
    EXPECT_EQ(output.lost_sways, 0U);
    return output.sways;
  }
  SteadinessWindows& windows() { return surroundings_.windows; }
  Stage& stage() { return *stage_; }

 private:
  StageSurroundings surroundings_;
  std::unique_ptr<Stage> stage_;
};

/// A step off the path of `signal` at a scan.
Signal shifted(Signal signal, std::size_t from, double mm) {
  for (std::size_t i = from; i < signal.scans(); ++i) signal.values[0][i] += mm;
  return signal;
}

Signal constant_cop(std::size_t scans, double ml_mm, double ap_mm, double hz = 100.0) {
  Signal signal = swaying_cop(hz, scans, 1);
  std::ranges::fill(signal.values[0], ml_mm);
  std::ranges::fill(signal.values[1], ap_mm);
  return signal;
}

TEST(Steadiness, SomebodyWhoDoesNotMove_HasNoPathAndNoDistance) {
  const auto events = Watching().watch(constant_cop(200, 123.456, -78.9));

  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(events[0].values.mean_ml_mm, 123.456, 1e-11);
  EXPECT_NEAR(events[0].values.mean_ap_mm, -78.9, 1e-11);
  EXPECT_LT(events[0].values.totex_mm, 1e-10);
  EXPECT_LT(events[0].values.rdist_mm, 1e-11);
}

/// Redoes trial 1 without a cue delay: the window of the new attempt, which begins at `first_scan`, is announced at once.
void repeat(Watching& watching, std::uint64_t first_scan) {
  watching.windows().close();
  watching.windows().open(1, 0, {first_scan}, {first_scan + 400});
}

/// "trial:first..last=samples" of each event; trial 0 is the free window.
std::string text_of(const std::vector<core::SwayEvent>& events) {
  std::ostringstream text;
  for (const core::SwayEvent& event : events) {
    text << event.trial << ':' << event.first_scan.value << ".." << event.scan.value << '=' << event.values.samples << ' ';
  }
  return text.str();
}

/// 100 Hz, blocks of 10 scans: values every 50 scans of a window, which describe what was 8 scans ago; free windows begin after 100 scans.
TEST(Steadiness, Windows_AreExactToTheScan) {
  struct Absence {
    std::size_t first;
    std::size_t scans;
  };
  struct Act {
    std::size_t at;
    void (*act)(Watching&);
  };
  struct Row {
    const char* name;
    std::vector<Absence> absences;
    std::vector<Act> acts;
    const char* expected;
  };
  const std::vector<Row> rows{
      {"no trial", {}, {}, "0:100..149=50 0:100..199=100 0:100..249=150 0:100..299=200 0:100..349=250 "},
      {"nobody", {{0, 400}}, {{0, [](Watching& w) { w.windows().open(1, 0, {100}, {300}); }}}, ""},
      {"steps off and on", {{160, 30}}, {}, "0:100..149=50 0:100..151=52 0:290..339=50 0:290..389=100 "},
      {"absent for 60 ms", {{160, 6}}, {}, "0:100..149=50 0:100..151=52 0:266..315=50 0:266..365=100 "},
      {"absent for 50 ms", {{160, 5}}, {}, "0:100..149=50 0:100..199=100 0:100..249=150 0:100..299=200 0:100..349=250 "},
      {"trial",
       {},
       {{0, [](Watching& w) { w.windows().open(7, 0, {123}, {345}); }}},
       "0:100..122=23 7:123..172=50 7:123..222=100 7:123..272=150 7:123..322=200 7:123..344=222 "},
      {"trial of another segment",
       {},
       {{0, [](Watching& w) { w.windows().open(7, 4, {123}, {345}); }}},
       "0:100..149=50 0:100..199=100 0:100..249=150 0:100..299=200 0:100..349=250 "},
      {"trial announced too late",
       {},
       {{60, [](Watching& w) { w.windows().open(2, 0, {20}, {300}); }}},
       "2:52..101=50 2:52..151=100 2:52..201=150 2:52..251=200 2:52..299=248 0:300..349=50 "},
      {"trial replaced by one that differs in its number only",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }}, {120, [](Watching& w) { w.windows().open(2, 0, {0}, {400}); }}},
       "1:0..49=50 1:0..99=100 1:0..111=112 2:112..161=50 2:112..211=100 2:112..261=150 2:112..311=200 2:112..361=250 "},
      {"trial replaced by a later one",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }}, {120, [](Watching& w) { w.windows().open(2, 0, {150}, {400}); }}},
       "1:0..49=50 1:0..99=100 1:0..111=112 0:112..149=38 2:150..199=50 2:150..249=100 2:150..299=150 2:150..349=200 "},
      {"trial announced twice",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }}, {120, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }}},
       "1:0..49=50 1:0..99=100 1:0..149=150 1:0..199=200 1:0..249=250 1:0..299=300 1:0..349=350 "},
      {"trial closed",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }}, {220, [](Watching& w) { w.windows().close(); }}},
       "1:0..49=50 1:0..99=100 1:0..149=150 1:0..199=200 1:0..211=212 0:212..261=50 0:212..311=100 0:212..361=150 "},
      {"a session begins",
       {},
       {{200, [](Watching& w) { w.windows().restart(); }}},
       "0:100..149=50 0:100..191=92 0:192..241=50 0:192..291=100 0:192..341=150 0:192..391=200 "},
      {"a trial is announced while a person stands",
       {},
       {{200, [](Watching& w) { w.windows().open(1, 0, {300}, {400}); }}},
       "0:100..149=50 0:100..191=92 0:192..241=50 0:192..291=100 0:192..299=108 1:300..349=50 "},
      {"a trial that was voided goes on",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }},
        {100, [](Watching& w) { w.windows().close(); }},
        {200, [](Watching& w) { w.windows().reopen(); }}},
       "1:0..49=50 1:0..91=92 0:100..149=50 1:0..192=193 1:0..199=200 1:0..249=250 1:0..299=300 1:0..349=350 "},
      {"a repeated trial whose redo is undone before the new attempt begins",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }},
        {100, [](Watching& w) { repeat(w, 300); }},
        {200, [](Watching& w) { w.windows().reopen(); }}},
       "1:0..49=50 1:0..91=92 0:100..149=50 1:0..192=193 1:0..199=200 1:0..249=250 1:0..299=300 1:0..349=350 "},
      {"a repeated trial whose redo is undone after the new attempt began",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {400}); }},
        {100, [](Watching& w) { repeat(w, 150); }},
        {220, [](Watching& w) { w.windows().reopen(); }}},
       "1:0..49=50 1:0..91=92 0:100..149=50 1:150..199=50 1:150..211=62 1:0..212=213 1:0..249=250 1:0..299=300 1:0..349=350 "},
      {"a trial that was voided before its window goes on after it would have begun",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {150}, {400}); }},
        {100, [](Watching& w) { w.windows().close(); }},
        {200, [](Watching& w) { w.windows().reopen(); }}},
       "0:100..149=50 1:150..192=43 1:150..199=50 1:150..249=100 1:150..299=150 1:150..349=200 "},
      {"a trial that was voided before its window goes on in time",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {250}, {400}); }},
        {100, [](Watching& w) { repeat(w, 350); }},
        {200, [](Watching& w) { w.windows().reopen(); }}},
       "0:100..149=50 0:100..199=100 0:100..249=150 1:250..299=50 1:250..349=100 "},
      {"a redo of a trial that has ended is undone",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {0}, {150}); }},
        {200, [](Watching& w) { repeat(w, 250); }},
        {300, [](Watching& w) { w.windows().reopen(); }}},
       "1:0..49=50 1:0..99=100 1:0..149=150 0:150..191=42 0:192..241=50 0:192..249=58 1:250..291=42 0:292..341=50 "
       "0:292..391=100 "},
      {"end earlier than planned",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {20}, {183}); }}, {150, [](Watching& w) { w.windows().end_at(0, {150}); }}},
       "1:20..69=50 1:20..119=100 1:20..149=130 0:150..199=50 0:150..249=100 0:150..299=150 0:150..349=200 "},
      {"end later than planned",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {20}, {153}); }}, {150, [](Watching& w) { w.windows().end_at(0, {300}); }}},
       "1:20..69=50 1:20..119=100 1:20..169=150 1:20..219=200 1:20..269=250 1:20..299=280 0:300..349=50 "},
      {"end in another segment closes it",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {20}, {153}); }}, {100, [](Watching& w) { w.windows().end_at(1, {30}); }}},
       "1:20..69=50 1:20..91=72 0:100..149=50 0:100..199=100 0:100..249=150 0:100..299=200 0:100..349=250 "},
      {"reset within a trial",
       {},
       {{0, [](Watching& w) { w.windows().open(1, 0, {10}, {200}); }}, {100, [](Watching& w) { w.stage().reset(); }}},
       "1:10..59=50 1:100..149=50 1:100..199=100 0:200..249=50 0:200..299=100 0:200..349=150 "},
      {"trial ends while nobody stands",
       {{180, 220}},
       {{0, [](Watching& w) { w.windows().open(1, 0, {100}, {300}); }}},
       "1:100..149=50 1:100..171=72 "},
      {"trial begins while somebody steps off",
       {{120, 50}},
       {{0, [](Watching& w) { w.windows().open(1, 0, {122}, {300}); }}},
       "0:100..111=12 1:122..171=2 1:122..221=52 1:122..271=102 1:122..299=130 0:300..349=50 "},
      {"trial ends while somebody steps off",
       {{120, 50}},
       {{0, [](Watching& w) { w.windows().open(1, 0, {20}, {122}); }}},
       "1:20..69=50 1:20..111=92 0:270..319=50 0:270..369=100 "},
  };
  for (const Row& row : rows) {
    Signal signal = swaying_cop(100.0, 400, 3);
    for (const Absence& absence : row.absences) step_off(signal, absence.first, absence.scans);
    Watching watching;
    std::vector<core::SwayEvent> events;
    for (std::size_t first = 0; first < 400; first += 10) {
      for (const Act& act : row.acts) {
        if (act.at == first) act.act(watching);
      }
      std::ranges::copy(watching.watch(until(from(signal, first), 10)), std::back_inserter(events));
    }
    EXPECT_EQ(text_of(events), row.expected) << row.name;
  }
}

/// A person who steps on at scan 0: first one foot with half of the load for `first_foot_scans`, at the plate's edge, then both feet. The
/// COP swings back and forth by 80 mm for 1 s before it is quiet.
Signal stepping_on(std::size_t first_foot_scans, std::size_t scans) {
  Signal signal = swaying_cop(100.0, scans, 3);
  for (std::size_t i = 0; i < first_foot_scans + 100 && i < scans; ++i) {
    const bool is_one_foot = i < first_foot_scans;
    const double after = static_cast<double>(i) - static_cast<double>(first_foot_scans);
    signal.values[0][i] += is_one_foot ? 120.0 : 80.0 * std::exp(-after / 40.0) * std::cos(after / 5.0);
    if (is_one_foot) signal.values[2][i] = 300.0;
  }
  return signal;
}

TEST(Steadiness, SteppingOn_IsLeftOut) {
  for (const std::size_t first_foot : {std::size_t{0}, std::size_t{30}, std::size_t{400}}) {
    const auto events = Watching().watch(stepping_on(first_foot, first_foot + 1000));

    ASSERT_FALSE(events.empty());
    const core::SwayEvent& last = events.back();
    EXPECT_GE(last.first_scan.value, first_foot + 100) << first_foot;
    EXPECT_LE(last.first_scan.value, first_foot + 300) << first_foot;
    EXPECT_LT(last.values.range_ml_mm, 35.0) << first_foot << ": of the sway alone; stepping on moved it by more than 80 mm";
    for (const core::SwayEvent& event : events) {
      EXPECT_LT(event.values.range_ml_mm, 35.0) << "at scan " << event.scan.value << ", first foot " << first_foot;
    }
  }
}

TEST(Steadiness, PersonWhoNeverStandsStill_IsMeasuredAfter5S) {
  Signal signal = swaying_cop(100.0, 1000, 3);
  for (std::size_t i = 0; i < signal.scans(); ++i) signal.values[0][i] += 60.0 * std::sin(0.1 * static_cast<double>(i));

  const auto events = Watching().watch(signal);

  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.front().first_scan.value, 500U);
}

/// The load rises in 0.5 s, overshoots and settles at 650 N. Later it is 5 % larger, as after a deep breath.
TEST(Steadiness, LoadThatSettled_IsTheReference_NotALoadOfTheRamp) {
  for (const double last_on_ramp_n : {530.0, 560.0, 600.0}) {
    Signal signal = swaying_cop(100.0, 1000, 3);
    for (std::size_t i = 0; i < 50; ++i) signal.values[2][i] = last_on_ramp_n * static_cast<double>(i + 1) / 50.0;
    for (std::size_t i = 600; i < signal.scans(); ++i) signal.values[2][i] *= 1.05;

    const auto events = Watching().watch(signal);

    ASSERT_FALSE(events.empty());
    for (const core::SwayEvent& event : events) EXPECT_EQ(event.first_scan, events.front().first_scan) << last_on_ramp_n;
  }
}

/// From 300 N to 700 N in 1 s, on the same place. Later, the load differs by 15 %.
TEST(Steadiness, LoadThatRisesSteadily_IsNotSteady) {
  Signal signal = swaying_cop(100.0, 1000, 3);
  for (std::size_t i = 0; i < signal.scans(); ++i) {
    signal.values[2][i] = i < 100 ? 300.0 + 4.0 * static_cast<double>(i) : i < 500 ? 700.0 : 805.0;
  }

  const auto events = Watching().watch(signal);

  ASSERT_FALSE(events.empty());
  EXPECT_GE(events.front().first_scan.value, 171U) << "at scan 71 the load is 584 N, 700 N are 20 % more";
  EXPECT_LE(events.front().first_scan.value, 200U);
  for (const core::SwayEvent& event : events) EXPECT_EQ(event.first_scan, events.front().first_scan) << "at scan " << event.scan.value;
}

TEST(Steadiness, FootThatIsLifted_EndsAWindowWithoutATrialOnly) {
  Signal signal = swaying_cop(100.0, 600, 3);
  std::fill(signal.values[2].begin() + 300, signal.values[2].end(), 400.0);
  EXPECT_EQ(text_of(Watching().watch(signal)).substr(0, 48), "0:100..149=50 0:100..199=100 0:100..249=150 0:10");
  EXPECT_EQ(Watching().watch(signal).back().first_scan.value, 400U) << "the load is steady again for 1 s";

  Watching in_trial;
  in_trial.windows().open(1, 0, {100}, {600});
  EXPECT_EQ(in_trial.watch(signal).back().first_scan.value, 100U);
}

TEST(Steadiness, WindowWithoutATrial_IsTheLast30S) {
  const Signal signal = swaying_cop(100.0, 12'000, 3);

  const auto events = Watching().watch(signal);

  core::SwayEvent last = events.back();
  EXPECT_EQ(last.values.samples, 3000U);
  EXPECT_EQ(last.scan.value - last.first_scan.value, 2999U);
  for (const core::SwayEvent& event : events) EXPECT_LE(event.values.samples, 3000U) << "at scan " << event.scan.value;
  Watching shorter;  // the same samples as the measurement of a trial: exact to the rounding of sums
  shorter.windows().open(1, 0, last.first_scan, {last.scan.value + 1});
  const core::SwayEvent same = shorter.watch(signal).back();
  ASSERT_EQ(same.values.samples, last.values.samples);
  EXPECT_NEAR(last.values.totex_mm, same.values.totex_mm, 1e-9 * same.values.totex_mm);
  EXPECT_NEAR(last.values.rdist_mm, same.values.rdist_mm, 1e-9 * same.values.rdist_mm);
  EXPECT_NEAR(last.values.pea95_f_mm2, same.values.pea95_f_mm2, 1e-9 * same.values.pea95_f_mm2);
  EXPECT_EQ(last.values.range_ml_mm, same.values.range_ml_mm);
  EXPECT_EQ(last.values.range_ap_mm, same.values.range_ap_mm);
}

TEST(Steadiness, WindowWithoutATrial_IsNotLongerAtAnyRate) {
  for (const double hz : {99.0, 128.0, 250.0, 1500.0}) {
    const auto events = Watching({}, hz).watch(swaying_cop(hz, static_cast<std::size_t>(40.0 * hz), 3));

    ASSERT_FALSE(events.empty());
    const core::RunningSway& values = events.back().values;
    EXPECT_LE(static_cast<double>(values.samples), core::kRecentSwayS * values.rate_hz) << hz;
    EXPECT_GE(static_cast<double>(values.samples), (core::kRecentSwayS - 0.5) * values.rate_hz) << hz;
  }
}

TEST(Steadiness, WindowWithoutATrial_IsNotLongerIfItsLengthIsNoMultipleOfTheInterval) {
  const auto events = Watching({{"every_ms", 700.0}}).watch(swaying_cop(100.0, 6000, 3));

  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().values.samples, 42U * 70U) << "29.4 s; 43 intervals would be 30.1 s";
}

TEST(Steadiness, UndoneRejectOrRedo_GivesTheValuesOfATrialThatWasNeverVoid) {
  const Signal signal = swaying_cop(100.0, 600, 3);
  Watching never;
  never.windows().open(1, 0, {20}, {500});
  const core::SwayEvent expected = never.watch(until(signal, 506)).back();

  const auto reject = [](Watching& watching) { watching.windows().close(); };
  const auto redo = [](Watching& watching) { repeat(watching, 150); };
  for (void (*const make_void)(Watching&) : {+reject, +redo}) {
    Watching undone;
    undone.windows().open(1, 0, {20}, {500});
    (void)undone.watch(until(signal, 100));
    make_void(undone);
    (void)undone.watch(until(from(signal, 100), 150));
    undone.windows().reopen();
    const core::SwayEvent last = undone.watch(until(from(signal, 250), 256)).back();

    EXPECT_EQ(last.trial, 1U);
    EXPECT_EQ(last.first_scan, expected.first_scan);
    EXPECT_EQ(last.scan, expected.scan);
    EXPECT_EQ(last.values.samples, expected.values.samples);
    EXPECT_EQ(last.values.totex_mm, expected.values.totex_mm);
    EXPECT_EQ(last.values.pea95_f_mm2, expected.values.pea95_f_mm2);
  }
}

TEST(Steadiness, RepeatedTrial_HasNoSampleOfTheVoidAttempt) {
  const Signal signal = swaying_cop(100.0, 400, 3);
  Watching watching;
  watching.windows().open(1, 0, {20}, {300});
  (void)watching.watch(until(signal, 100));
  watching.windows().close();
  (void)watching.watch(until(from(signal, 100), 50));
  watching.windows().open(1, 0, {200}, {400});

  const core::SwayEvent last = watching.watch(from(signal, 150)).back();

  EXPECT_EQ(last.first_scan.value, 200U);
  EXPECT_EQ(last.values.samples, last.scan.value - 199U);
}

TEST(Steadiness, VoidTrialInAState_ContinuesAfterItsUndo) {
  const Signal signal = swaying_cop(100.0, 400, 3);
  Watching one;
  one.windows().open(1, 0, {20}, {400});
  (void)one.watch(until(signal, 100));
  repeat(one, 110);
  (void)one.watch(until(from(signal, 100), 50));
  std::vector<double> state(one.stage().state_size());
  one.stage().save(state);
  Watching other;
  ASSERT_TRUE(other.stage().restore(state));
  one.windows().reopen();
  other.windows().open(1, 0, {20}, {400});

  EXPECT_EQ(text_of(other.watch(from(signal, 150))), text_of(one.watch(from(signal, 150))));
}

TEST(Steadiness, LoadThatIsNotAboveZero_IsNobody) {
  Signal signal = swaying_cop(100.0, 500, 3);
  std::ranges::fill(signal.values[2], 0.0);

  EXPECT_THAT(Watching().watch(signal), testing::IsEmpty());
}

TEST(Steadiness, FilterAtTheFullRate_TakesAwayWhatIsAbove10Hz) {
  Signal signal = constant_cop(3000, 0.0, 0.0, 1000.0);
  for (std::size_t i = 0; i < signal.scans(); ++i) {
    const double time_s = static_cast<double>(i) / 1000.0;
    signal.values[0][i] = 10.0 * std::sin(2.0 * M_PI * 110.0 * time_s);  // at 100 Hz without a filter: 10 Hz
    signal.values[1][i] = 10.0 * std::sin(2.0 * M_PI * 1.0 * time_s);
  }

  const auto events = Watching({}, 1000.0).watch(signal, 64);

  ASSERT_GE(events.size(), 2U);
  const core::RunningSway& values = events[1].values;  // 1 to 2 s: one period of the slow one
  EXPECT_EQ(values.rate_hz, 100.0);
  EXPECT_EQ(values.samples, 100U);
  EXPECT_LT(values.range_ml_mm, 0.01);
  EXPECT_NEAR(values.totex_ap_mm, 40.0 - 0.2 * M_PI, 0.1);  // up, down and up by 10 mm, without the last hundredth of the period
  EXPECT_NEAR(values.range_ap_mm, 20.0, 0.05);
}

TEST(Steadiness, GapOf50Ms_IsAStraightLineThroughIt) {
  Signal signal = constant_cop(300, 0.0, 0.0);
  for (std::size_t i = 0; i < 300; ++i) signal.values[0][i] = 0.1 * static_cast<double>(i);
  Signal with_gap = signal;
  step_off(with_gap, 160, 5);

  const auto whole = Watching().watch(signal);
  const auto bridged = Watching().watch(with_gap, 7);

  ASSERT_EQ(bridged.size(), whole.size());
  for (std::size_t k = 0; k < whole.size(); ++k) {
    EXPECT_EQ(bridged[k].scan, whole[k].scan);
    EXPECT_EQ(bridged[k].values.samples, whole[k].values.samples);
    EXPECT_NEAR(bridged[k].values.totex_mm, whole[k].values.totex_mm, 1e-9);
    EXPECT_NEAR(bridged[k].values.rdist_mm, whole[k].values.rdist_mm, 1e-9);
  }
}

TEST(Steadiness, EndInAnotherSegmentOrOfNoWindow_ClosesIt) {
  Watching watching;
  watching.windows().end_at(0, {300});
  EXPECT_EQ(watching.windows().latest().trial, 0U);
  watching.windows().open(1, 0, {20}, {153});
  watching.windows().end_at(1, {30});
  EXPECT_EQ(watching.windows().latest().trial, 0U);
}

TEST(Steadiness, LongGapInATrial_IsNoPath) {
  Signal signal = constant_cop(400, 0.0, 0.0);
  signal = shifted(signal, 200, 100.0);  // steps off, and on again elsewhere
  step_off(signal, 150, 50);
  Watching watching;
  watching.windows().open(1, 0, {0}, {400});

  const auto events = watching.watch(signal);

  ASSERT_FALSE(events.empty());
  const core::SwayEvent& last = events.back();
  EXPECT_EQ(last.trial, 1U);
  EXPECT_EQ(last.first_scan.value, 0U);
  EXPECT_EQ(last.scan.value, 349U);
  EXPECT_EQ(last.values.samples, 292U);  // 0 to 141, 200 to 349
  EXPECT_LT(last.values.totex_mm, 1e-9);
  EXPECT_NEAR(last.values.range_ml_mm, 100.0, 1e-9);
}

TEST(Steadiness, DecimatedAndDelayedInput_IsCountedInScansOfTheRawStream) {
  // 500 Hz, averaged over 5 scans, every fifth: the COP comes at 100 Hz and describes what was two scans ago.
  StageSurroundings surroundings;
  StageContext context = surroundings.context();
  context.raw_rate = rate_hz(500.0);
  const auto stage = create_stage({.id = "steadiness", .options = {}}, context).value();
  Signal signal = swaying_cop(100.0, 400, 3);
  signal.format.delay_ns = 4'000'000;
  ASSERT_TRUE(stage->prepare(signal.format, 64));
  surroundings.windows.open(1, 0, {499}, {999});

  const std::size_t block = 8;
  const auto events = run(*stage, 0, signal, std::span(&block, 1)).sways;

  // Sample i describes scan 5 i - 2: the first from 499 on is 101, the last before 999 is 200.
  ASSERT_EQ(events.size(), 6U);  // one of the free window before, two of the trial, three of the free window after
  EXPECT_EQ(events[0].scan.value, 100U * 5 - 2);
  EXPECT_EQ(events[1].first_scan.value, 101U * 5 - 2);
  EXPECT_EQ(events[2].scan.value, 200U * 5 - 2);
  EXPECT_EQ(events[2].values.samples, 100U);
  EXPECT_EQ(events[2].host_time_ns, host_time_ns(rate_hz(500.0), events[2].scan.value));
}

TEST(Steadiness, StateOfDtsd01_BeginsAWindowAgain) {
  const Signal signal = swaying_cop(100.0, 400, 3);
  Watching before;
  (void)before.watch(until(signal, 200));
  std::vector<double> state(before.stage().state_size());
  before.stage().save(state);
  const std::size_t added = before.stage().state_added_since_0_1();
  std::fill(state.end() - static_cast<std::ptrdiff_t>(added), state.end(), 0.0);  // as Pipeline::restore completes it

  Watching after;
  ASSERT_TRUE(after.stage().restore(state));
  const auto events = after.watch(from(signal, 200));

  ASSERT_FALSE(events.empty());
  EXPECT_GE(events.front().first_scan.value, 192U);
  EXPECT_EQ(events.back().values.samples, 150U + 8U);
}

TEST(Steadiness, MoreEventsInABlockThanThereIsRoomFor_LeavesTheNewest) {
  StageSurroundings surroundings;
  const auto stage = surroundings.make({.id = "steadiness", .options = {}});
  const Signal signal = swaying_cop(100.0, 460, 3);
  ASSERT_TRUE(stage->prepare(signal.format, 460));
  const std::size_t block = 460;

  const Output output = run(*stage, 0, signal, std::span(&block, 1));

  ASSERT_EQ(output.sways.size(), 2U);
  EXPECT_EQ(output.sways[0].scan.value, 399U);
  EXPECT_EQ(output.sways[1].scan.value, 449U);
  EXPECT_EQ(output.lost_sways, 5U);
}

}  // namespace
}  // namespace dts::pipeline
