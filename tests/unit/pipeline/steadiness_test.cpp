// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/steadiness.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "pipeline/pipeline.h"
#include "unit/pipeline/standing_cop.h"

namespace dts::pipeline {
namespace {

using testing::HasSubstr;

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

/// The rest of `signal`.
Signal from(const Signal& signal, std::size_t first) {
  Signal rest = signal;
  for (auto& column : rest.values) column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  for (auto& column : rest.bits) column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  rest.first_scan = signal.first_scan + first;
  return rest;
}

Signal until(Signal signal, std::size_t scans) {
  for (auto& column : signal.values) column.resize(scans);
  for (auto& column : signal.bits) column.resize(scans);
  return signal;
}

TEST(Steadiness, SomebodyStands_IsToldEveryHalfSecondAfterOne) {
  const auto events = Watching().watch(swaying_cop(100.0, 260, 3));

  ASSERT_EQ(events.size(), 3U);
  for (std::size_t k = 0; k < events.size(); ++k) {
    EXPECT_EQ(events[k].trial, 0U);
    EXPECT_EQ(events[k].first_scan.value, 100U);
    EXPECT_EQ(events[k].scan.value, 150U + 50 * k);
    EXPECT_EQ(events[k].values.samples, 51U + 50 * k);
    EXPECT_EQ(events[k].host_time_ns, host_time_ns(rate_hz(100.0), events[k].scan.value));
    EXPECT_EQ(events[k].values.rate_hz, 100.0);
    EXPECT_GT(events[k].values.totex_mm, 0.0);
  }
  EXPECT_GT(events[2].values.totex_mm, events[1].values.totex_mm);
}

TEST(Steadiness, SomebodyWhoDoesNotMove_HasNoPathAndNoDistance) {
  const auto events = Watching().watch(constant_cop(200, 123.456, -78.9));

  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(events[0].values.mean_ml_mm, 123.456, 1e-11);
  EXPECT_NEAR(events[0].values.mean_ap_mm, -78.9, 1e-11);
  EXPECT_LT(events[0].values.totex_mm, 1e-10);
  EXPECT_LT(events[0].values.rdist_mm, 1e-11);
}

TEST(Steadiness, NobodyStands_SaysNothing) {
  Signal signal = swaying_cop(100.0, 500, 3);
  step_off(signal, 0, 500);
  Watching watching;
  watching.windows().open(1, 0, {100}, {300});

  EXPECT_THAT(watching.watch(signal), testing::IsEmpty());
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
  EXPECT_EQ(values.samples, 101U);
  EXPECT_LT(values.range_ml_mm, 0.01);
  EXPECT_NEAR(values.totex_ap_mm, 40.0, 0.1);  // up, down and up by 10 mm: 4 amplitudes
  EXPECT_NEAR(values.range_ap_mm, 20.0, 0.05);
}

TEST(Steadiness, StepOff_EndsTheWindowAndAnotherBeginsASecondAfterSteppingOn) {
  Signal signal = swaying_cop(100.0, 500, 3);
  step_off(signal, 220, 30);

  const auto events = Watching().watch(signal);

  ASSERT_EQ(events.size(), 5U);
  EXPECT_EQ(events[2].scan.value, 211U);  // the end: what was filtered of it, and the filter is eight samples late
  EXPECT_EQ(events[2].first_scan.value, 100U);
  EXPECT_EQ(events[2].values.samples, 112U);
  EXPECT_EQ(events[3].first_scan.value, 350U);
  EXPECT_EQ(events[3].values.samples, 51U);
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

TEST(Steadiness, GapOf60Ms_IsNone) {
  Signal signal = swaying_cop(100.0, 200, 3);
  step_off(signal, 160, 6);

  const auto events = Watching().watch(signal);

  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1].scan.value, 151U);
}

TEST(Steadiness, TrialsWindow_IsExactToTheScan) {
  Watching watching;
  watching.windows().open(7, 0, {123}, {345});

  const auto events = watching.watch(swaying_cop(100.0, 410, 3));

  // The free window: 150 is not reached; its end at 122. Then 173, 223, ... of the trial, and its end.
  std::vector<std::uint64_t> scans;
  for (const auto& event : events) scans.push_back(event.scan.value);
  EXPECT_THAT(scans, testing::ElementsAre(122, 173, 223, 273, 323, 344, 395));
  EXPECT_EQ(events[0].trial, 0U);
  for (std::size_t k = 1; k < 6; ++k) {
    EXPECT_EQ(events[k].trial, 7U);
    EXPECT_EQ(events[k].first_scan.value, 123U);
  }
  EXPECT_EQ(events[5].values.samples, 222U);
  EXPECT_EQ(events[6].trial, 0U);
  EXPECT_EQ(events[6].first_scan.value, 345U);  // free windows go on from there
}

TEST(Steadiness, WindowToldTooLate_BeginsAtOnce) {
  Watching watching;
  const Signal signal = swaying_cop(100.0, 400, 3);
  (void)watching.watch(until(signal, 60));
  watching.windows().open(2, 0, {20}, {300});

  const auto events = watching.watch(from(signal, 60));

  ASSERT_GE(events.size(), 5U);
  EXPECT_EQ(events[0].first_scan.value, 52U);  // which the next filtered sample describes
  EXPECT_EQ(events[4].scan.value, 299U);
  EXPECT_EQ(events[4].values.samples, 248U);
}

TEST(Steadiness, WindowClosedOrReplaced_EndsThere) {
  Watching watching;
  const Signal signal = swaying_cop(100.0, 400, 3);
  watching.windows().open(1, 0, {0}, {400});
  (void)watching.watch(until(signal, 120));
  watching.windows().open(2, 0, {150}, {400});

  const auto replaced = watching.watch(until(from(signal, 120), 100));
  watching.windows().close();
  const auto closed = watching.watch(from(signal, 220));

  ASSERT_GE(replaced.size(), 2U);
  EXPECT_EQ(replaced[0].trial, 1U);
  EXPECT_EQ(replaced[0].scan.value, 111U);
  EXPECT_EQ(replaced[1].trial, 0U);
  EXPECT_EQ(replaced[1].scan.value, 149U);
  EXPECT_EQ(replaced.back().trial, 2U);
  ASSERT_GE(closed.size(), 2U);
  EXPECT_EQ(closed[0].trial, 2U);
  EXPECT_EQ(closed[0].scan.value, 211U);
  EXPECT_EQ(closed[1].trial, 0U);
}

TEST(Steadiness, WindowWhoseEndIsToldWhileItRuns_GoesOnUpToThere) {
  for (const std::uint64_t end : {150U, 157U, 300U}) {  // planned: 153; whoever runs trials is ahead of the stage, and may differ by a scan
    const Signal signal = swaying_cop(100.0, 400, 3);
    Watching watching({{"settle_ms", 60'000.0}});
    watching.windows().open(1, 0, {20}, {153});
    static_cast<void>(watching.watch(until(signal, 150)));
    watching.windows().end_at(0, {end});
    const auto events = watching.watch(from(signal, 150));

    ASSERT_FALSE(events.empty()) << end;
    EXPECT_EQ(events.back().trial, 1U);
    EXPECT_EQ(events.back().first_scan.value, 20U);
    EXPECT_EQ(events.back().scan.value, end - 1);
    EXPECT_EQ(events.back().values.samples, end - 20);
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

TEST(Steadiness, WindowOfAnotherSegment_IsNotMeasured) {
  Watching watching;
  watching.windows().open(1, 4, {10}, {200});

  for (const auto& event : watching.watch(swaying_cop(100.0, 300, 3))) EXPECT_EQ(event.trial, 0U);
}

TEST(Steadiness, ResetWithinATrial_BeginsItAnew) {
  Watching watching;
  watching.windows().open(1, 0, {10}, {200});
  const Signal signal = swaying_cop(100.0, 300, 3);
  (void)watching.watch(until(signal, 100));

  watching.stage().reset();
  const auto events = watching.watch(from(signal, 100));

  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events[1].trial, 1U);
  EXPECT_EQ(events[1].first_scan.value, 100U);
  EXPECT_EQ(events[1].scan.value, 199U);
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
  EXPECT_EQ(last.scan.value, 350U);
  EXPECT_EQ(last.values.samples, 293U);  // 0 to 141, 200 to 350
  EXPECT_LT(last.values.totex_mm, 1e-9);
  EXPECT_NEAR(last.values.range_ml_mm, 100.0, 1e-9);
}

TEST(Steadiness, TrialThatEndsWhileNobodyStands_IsToldItsLastValues) {
  Signal signal = swaying_cop(100.0, 400, 3);
  step_off(signal, 180, 220);
  Watching watching;
  watching.windows().open(1, 0, {100}, {300});

  const auto events = watching.watch(signal);

  ASSERT_EQ(events.size(), 2U);  // the free window has nothing before 100
  EXPECT_EQ(events[1].scan.value, 171U);
  EXPECT_EQ(events[1].values.samples, 72U);
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
  surroundings.windows.open(1, 0, {501}, {1000});

  const std::size_t block = 8;
  const auto events = run(*stage, 0, signal, std::span(&block, 1)).sways;

  // Sample i describes scan 5 i - 2: the first from 501 on is 101, the last before 1000 is 200.
  ASSERT_EQ(events.size(), 6U);  // one of the free window before, two of the trial, three of the free window after
  EXPECT_EQ(events[0].scan.value, 100U * 5 - 2);
  EXPECT_EQ(events[1].first_scan.value, 101U * 5 - 2);
  EXPECT_EQ(events[2].scan.value, 200U * 5 - 2);
  EXPECT_EQ(events[2].values.samples, 100U);
  EXPECT_EQ(events[2].host_time_ns, host_time_ns(rate_hz(500.0), events[2].scan.value));
}

TEST(Steadiness, MoreEventsInABlockThanThereIsRoomFor_LeavesTheNewest) {
  StageSurroundings surroundings;
  const auto stage = surroundings.make({.id = "steadiness", .options = {}});
  const Signal signal = swaying_cop(100.0, 460, 3);
  ASSERT_TRUE(stage->prepare(signal.format, 460));
  const std::size_t block = 460;

  const Output output = run(*stage, 0, signal, std::span(&block, 1));

  ASSERT_EQ(output.sways.size(), 2U);
  EXPECT_EQ(output.sways[0].scan.value, 400U);
  EXPECT_EQ(output.sways[1].scan.value, 450U);
  EXPECT_EQ(output.lost_sways, 5U);
}

TEST(Steadiness, InputThatIsNoCop_IsRefused) {
  StageSurroundings surroundings;
  const auto stage = surroundings.make({.id = "steadiness", .options = {}});

  const auto volts = stage->prepare(make_signal(100.0, "V", {{}, {}, {}, {}}).format, 64);
  const auto slow = stage->prepare(swaying_cop(20.0, 0, 1).format, 64);

  ASSERT_FALSE(volts);
  EXPECT_THAT(volts.error().what, HasSubstr("not a centre of pressure"));
  ASSERT_FALSE(slow);
  EXPECT_THAT(slow.error().what, HasSubstr("too slow"));
  EXPECT_TRUE(stage->prepare(swaying_cop(25.0, 0, 1).format, 64));
}

}  // namespace
}  // namespace dts::pipeline
