// SPDX-License-Identifier: Apache-2.0
#include "session/acquisition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "scripted_device.h"

namespace dts::session {
namespace {

using device::ReadOutcome;

/// An acquisition at 100 Hz over a script, in virtual time, that the test runs itself.
struct Live {
  explicit Live(std::deque<ScriptedDevice::Step> script, std::size_t ring_blocks = 8)
      : device(std::move(script)), ring(ring_blocks, core::Acquired{.block = core::Block(1, kBlock)}) {}
  static constexpr std::size_t kBlock = 8;
  core::VirtualClock clock;
  core::Doorbell bell;
  ScriptedDevice device;
  core::SpscRing<core::Acquired> ring;
  Acquisition acquisition{device, clock, ring, bell, core::Rate::create(100, 1).value(), kBlock};
};

/// Runs an acquisition over a script on the calling thread and keeps what came out.
struct Playback : Live {
  struct Seen {
    std::uint32_t segment;
    std::uint64_t first_scan;
    std::size_t count;
    core::Gap gap;
    std::uint64_t lost_total;
  };
  explicit Playback(std::deque<ScriptedDevice::Step> script, std::size_t ring_blocks = 64, int failing_opens = 0)
      : Live(std::move(script), ring_blocks) {
    device.failing_opens = failing_opens;
    device.on_end = [&] { acquisition.request_stop(); };
    acquisition.run();
    report = acquisition.report();
    while (const core::Acquired* acquired = ring.front()) {
      seen.push_back({acquired->block.segment, acquired->block.first_scan.value, acquired->block.count(), acquired->gap_before,
                      acquired->lost_scans_total});
      ring.release();
    }
  }
  AcquisitionReport report;
  std::vector<Seen> seen;
};

TEST(Acquisition, UnbrokenStream_IsOneSegmentWithoutGap) {
  const Playback run({{.scans = 2}, {.scans = 8}, {.scans = 1}});

  ASSERT_EQ(run.seen.size(), 3U);
  EXPECT_EQ(run.seen[0].segment, 0U);
  EXPECT_EQ(run.seen[2].first_scan, 10U);
  EXPECT_EQ(run.seen[2].segment, 0U);
  EXPECT_EQ(run.report.scans_total, 11U);
  EXPECT_EQ(run.report.losses.total().gaps, 0U);
}

TEST(Acquisition, DeviceGap_StartsASegmentAtZeroAndIsToldOnce) {
  const core::Gap overrun{.reason = core::GapReason::Overrun, .missing_scans = 5, .is_exact = true};
  const Playback run({{.scans = 3}, {.outcome = ReadOutcome::Gap, .gap = overrun}, {.scans = 2}, {.scans = 2}});

  ASSERT_EQ(run.seen.size(), 3U);
  EXPECT_EQ(run.seen[1].segment, 1U);
  EXPECT_EQ(run.seen[1].first_scan, 0U);
  EXPECT_EQ(run.seen[1].gap.reason, core::GapReason::Overrun);
  EXPECT_EQ(run.seen[1].gap.missing_scans, 5U);
  EXPECT_TRUE(run.seen[1].gap.is_exact);
  EXPECT_EQ(run.seen[2].gap.reason, core::GapReason::None);
  EXPECT_EQ(run.seen[2].first_scan, 2U);
  EXPECT_EQ(run.report.losses.total().scans, 5U);
}

TEST(Acquisition, Unplug_ReopensAndEstimatesTheHoleFromHostTime) {
  const Playback run({{.scans = 1}, {.outcome = ReadOutcome::Gone}, {.scans = 1, .pause_ns = 40 * ScriptedDevice::kPeriodNs}});

  ASSERT_EQ(run.seen.size(), 2U);
  EXPECT_EQ(run.seen[1].gap.reason, core::GapReason::Unplugged);
  EXPECT_EQ(run.seen[1].gap.missing_scans, 40U);
  EXPECT_FALSE(run.seen[1].gap.is_exact);
  EXPECT_EQ(run.report.reconnects_total, 1U);
  EXPECT_EQ(run.device.opens, 2);
}

TEST(Acquisition, FullRing_DropsTheNewBlocksAndCountsThemExactly) {
  // The ring has 8 slots and nobody reads: of 12 blocks the last 4 are lost, and nothing can tell of it yet.
  const Playback run(std::deque<ScriptedDevice::Step>(12, {.scans = 2}), 8);

  EXPECT_EQ(run.seen.size(), 8U);
  EXPECT_EQ(run.ring.dropped(), 4U);
}

TEST(Acquisition, RoomAfterFullRing_TellsTheExactLossBeforeTheNextBlock) {
  Live live(std::deque<ScriptedDevice::Step>(6, {.scans = 2}), 2);
  std::vector<core::Gap> gaps;
  const auto drain = [&] {
    while (const core::Acquired* acquired = live.ring.front()) {
      gaps.push_back(acquired->gap_before);
      live.ring.release();
    }
  };
  int rounds = 0;
  live.device.on_end = [&] {
    if (++rounds == 4) return live.acquisition.request_stop();
    drain();  // room again: one more block must carry the loss of four, and none behind it
    live.device.extend({{.scans = 2}});
  };

  live.acquisition.run();
  drain();

  ASSERT_EQ(gaps.size(), 5U);
  for (const std::size_t whole : {0U, 1U, 3U, 4U}) EXPECT_EQ(gaps[whole].reason, core::GapReason::None) << whole;
  EXPECT_EQ(gaps[2].reason, core::GapReason::RingFull);
  EXPECT_EQ(gaps[2].missing_scans, 8U);
  EXPECT_TRUE(gaps[2].is_exact);
}

TEST(Acquisition, CounterJumpWithoutNotice_IsAnIntegrityGap) {
  const Playback run({{.scans = 2}, {.scans = 2, .skip_index = 3}});

  ASSERT_EQ(run.seen.size(), 2U);
  EXPECT_EQ(run.seen[1].gap.reason, core::GapReason::Integrity);
  EXPECT_EQ(run.seen[1].gap.missing_scans, 3U);
  EXPECT_EQ(run.seen[1].first_scan, 0U);
}

TEST(Acquisition, DeviceAbsentAtStart_IsTriedAgainAndIsNoGap) {
  const Playback run({{.scans = 1}}, 64, 3);

  ASSERT_EQ(run.seen.size(), 1U);
  EXPECT_EQ(run.seen[0].gap.reason, core::GapReason::None);
  EXPECT_EQ(run.device.opens, 4);
  EXPECT_EQ(run.report.reconnects_total, 0U);
}

TEST(Acquisition, TwoGapsInARow_BecomeOneLongerGap) {
  const core::Gap exact{.reason = core::GapReason::Overrun, .missing_scans = 5, .is_exact = true};
  const core::Gap estimated{.reason = core::GapReason::Silence, .missing_scans = 7, .is_exact = false};
  const Playback run(
      {{.scans = 1}, {.outcome = ReadOutcome::Gap, .gap = exact}, {.outcome = ReadOutcome::Gap, .gap = estimated}, {.scans = 1}});

  ASSERT_EQ(run.seen.size(), 2U);
  EXPECT_EQ(run.seen[1].gap.missing_scans, 12U);
  EXPECT_FALSE(run.seen[1].gap.is_exact);
  EXPECT_EQ(run.report.losses.total().gaps, 1U);
}

TEST(Acquisition, UnknownHoleAfterACountedOne_IsAsLongAsTheTimeBetweenTheScans) {
  const core::Gap exact{.reason = core::GapReason::Overrun, .missing_scans = 5, .is_exact = true};
  const Playback run({{.scans = 1},
                      {.outcome = ReadOutcome::Gap, .gap = exact},
                      {.outcome = ReadOutcome::Gone},
                      {.scans = 1, .pause_ns = 600 * ScriptedDevice::kPeriodNs}});

  ASSERT_EQ(run.seen.size(), 2U);
  EXPECT_EQ(run.seen[1].gap.missing_scans, 600U);
  EXPECT_EQ(run.report.losses.total().scans, 600U);
}

TEST(Acquisition, HostTimeJumpsByMoreThanASecond_IsASilenceGap) {
  const Playback run({{.scans = 2}, {.scans = 2, .pause_ns = 500 * ScriptedDevice::kPeriodNs}});

  ASSERT_EQ(run.seen.size(), 2U);
  EXPECT_EQ(run.seen[1].gap.reason, core::GapReason::Silence);
  EXPECT_EQ(run.seen[1].gap.missing_scans, 500U);
  EXPECT_EQ(run.seen[1].segment, 1U);
}

TEST(Acquisition, DeviceGoneAtEveryFirstRead_IsRetriedWithGrowingPauses) {
  const Playback run(std::deque<ScriptedDevice::Step>(5, {.outcome = ReadOutcome::Gone}));

  // 0.25, 0.5, 1, 2, 4 s: as fast as it computes would be none of them.
  EXPECT_GE(run.clock.now_ns(), 7'750'000'000);
  EXPECT_EQ(run.report.losses.total().gaps, 0U);
}

TEST(Acquisition, StreamThatBreaksAfterSeconds_IsStartedAgainAtOnceInANewSegment) {
  const core::Gap doubt{.reason = core::GapReason::Integrity};
  std::deque<ScriptedDevice::Step> script(130, {.scans = 8});
  script.push_back({.outcome = ReadOutcome::Broken, .gap = doubt});
  script.push_back({.scans = 2, .pause_ns = 30 * ScriptedDevice::kPeriodNs});
  const Playback run(script, 256);

  ASSERT_EQ(run.seen.size(), 131U);
  EXPECT_EQ(run.seen[130].segment, 1U);
  EXPECT_EQ(run.seen[130].first_scan, 0U);
  EXPECT_EQ(run.seen[130].gap.reason, core::GapReason::Integrity);
  EXPECT_EQ(run.seen[130].gap.missing_scans, 30U);
  EXPECT_FALSE(run.seen[130].gap.is_exact);
  EXPECT_EQ(run.device.starts, 2);
  EXPECT_EQ(run.report.restarts_total, 1U);
  EXPECT_EQ(run.report.reconnects_total, 0U);
  EXPECT_EQ(run.clock.now_ns(), 0) << "a stream that ran before is started again without a pause";
}

TEST(Acquisition, StreamThatBreaksSecondsAfterItsReturn_IsStartedAgainAtOnce) {
  std::deque<ScriptedDevice::Step> script{{.scans = 8}, {.outcome = ReadOutcome::Gone}};
  script.insert(script.end(), 4, {.outcome = ReadOutcome::Gone});  // the pauses have grown meanwhile
  script.insert(script.end(), 38, {.scans = 8});                   // 3 s
  script.push_back({.outcome = ReadOutcome::Broken, .gap = {.reason = core::GapReason::Stall}});
  script.push_back({.scans = 8});
  const Playback run(script);

  EXPECT_EQ(run.clock.now_ns(), 3'750'000'000) << "0.25 + 0.5 + 1 + 2 s while it was away, and nothing after the stall";
  EXPECT_EQ(run.seen.back().gap.reason, core::GapReason::Stall);
}

TEST(Acquisition, StreamThatBreaksRightAfterItsReturn_IsStartedAgainAtOnce) {
  std::deque<ScriptedDevice::Step> script(130, {.scans = 8});
  script.insert(script.end(), 5, {.outcome = ReadOutcome::Gone});  // the pauses have grown meanwhile
  script.push_back({.scans = 8});                                  // 80 ms
  script.push_back({.outcome = ReadOutcome::Broken, .gap = {.reason = core::GapReason::Stall}});
  script.push_back({.scans = 8});
  script.push_back({.outcome = ReadOutcome::Broken});
  script.push_back({.scans = 8});
  const Playback run(script, 256);

  EXPECT_EQ(run.clock.now_ns(), 3'750'000'000 + 250'000'000) << "while it was away; nothing after the first break, then gently";
}

TEST(Acquisition, FirstBreakOfAll_IsStartedAgainAtOnce) {
  const Playback run({{.scans = 8}, {.outcome = ReadOutcome::Broken}, {.scans = 8}});

  EXPECT_EQ(run.clock.now_ns(), 0);
  EXPECT_EQ(run.report.restarts_total, 1U);
}

TEST(Acquisition, StreamThatBreaksAgainAndAgain_IsRetriedWithGrowingPauses) {
  std::deque<ScriptedDevice::Step> script;
  for (int i = 0; i < 6; ++i) {
    script.push_back({.scans = 8});
    script.push_back({.outcome = ReadOutcome::Broken});
  }
  const Playback run(script);

  EXPECT_GE(run.clock.now_ns(), 7'750'000'000);
  EXPECT_EQ(run.report.losses.total().gaps, 5U);
}

TEST(Acquisition, SuspendedMachine_TheTimeAsleepIsInTheGap) {
  std::deque<ScriptedDevice::Step> script(1, {.scans = 1});
  script.push_back({.outcome = ReadOutcome::Gone});
  Live live(script);
  bool has_slept = false;
  live.device.on_end = [&] {
    if (std::exchange(has_slept, true)) return live.acquisition.request_stop();
    live.clock.suspend_ns(3600'000'000'000);
    live.device.extend({{.scans = 1, .pause_ns = 40 * ScriptedDevice::kPeriodNs}});
  };

  live.acquisition.run();

  ASSERT_NE(live.ring.front(), nullptr);
  live.ring.release();
  ASSERT_NE(live.ring.front(), nullptr);
  EXPECT_EQ(live.ring.front()->gap_before.missing_scans, 360'000U + 40U);
}

TEST(Acquisition, ArmedDevice_IsWaitingAndNotSilent) {
  Live live(std::deque<ScriptedDevice::Step>(3, {.outcome = ReadOutcome::Armed}));
  AcquisitionReport armed;
  bool has_fired = false;
  live.device.on_end = [&] {
    if (std::exchange(has_fired, true)) return live.acquisition.request_stop();
    armed = live.acquisition.report();
    live.device.extend({{.scans = 1}});
  };

  live.acquisition.run();

  EXPECT_TRUE(armed.is_armed);
  EXPECT_FALSE(armed.is_silent);
  EXPECT_EQ(armed.text(), "waiting for the external trigger");
  EXPECT_FALSE(live.acquisition.report().is_armed);
  EXPECT_EQ(live.acquisition.report().text(), "");
}

/// The report when reads in which nothing came each took so long, one after the other.
std::string report_after_reads_that_took(std::int64_t read_ns, int reads) {
  Live live(std::deque<ScriptedDevice::Step>(1, {.scans = 1}));
  std::string reported;
  live.device.on_end = [&] {
    reported = live.acquisition.report().text();
    if (reads-- == 0) live.acquisition.request_stop();
    live.clock.advance_ns(read_ns);
  };
  live.acquisition.run();
  return reported;
}

TEST(Acquisition, DeviceThatDeliversNothing_IsToldAfterASecond) {
  EXPECT_NE(report_after_reads_that_took(200'000'000, 8).find("check its cable"), std::string::npos);
}

TEST(Acquisition, ProcessThatStoodStill_IsNoNewsOfTheDevice) { EXPECT_EQ(report_after_reads_that_took(5'000'000'000, 1), ""); }

TEST(Acquisition, UnitThatIsPluggedIn_EndsThePauseBeforeTheNextTry) {
  Live live(std::deque<ScriptedDevice::Step>(1, {.scans = 1}));
  live.device.failing_opens = 5;
  live.device.on_arrival_question = [&] { return live.device.opens == 5; };
  live.device.on_end = [&] { live.acquisition.request_stop(); };

  live.acquisition.run();

  EXPECT_EQ(live.device.opens, 6);
  EXPECT_LT(live.clock.now_ns(), 4'000'000'000) << "0.25 + 0.5 + 1 + 2 s, and not 4 s more";
}

TEST(Acquisition, DeviceThatRunsAtAnotherRateThanItPromised_IsNotBelieved) {
  Live live(std::deque<ScriptedDevice::Step>(1, {.scans = 1}));
  live.device.starts_at_rate_factor = 1.01;
  live.device.on_arrival_question = [&] {
    live.acquisition.request_stop();
    return false;
  };

  live.acquisition.run();

  EXPECT_EQ(live.ring.front(), nullptr);
  EXPECT_THAT(std::string(live.acquisition.report().text()), testing::HasSubstr("promised 100"));
}

TEST(AcquisitionReport, LongMessage_IsCutNotOverrun) {
  AcquisitionReport report;

  report.set_message(std::string(1000, 'x'));

  EXPECT_EQ(report.text().size(), 511U);
}

}  // namespace
}  // namespace dts::session
