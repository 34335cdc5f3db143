// SPDX-License-Identifier: Apache-2.0
// The rules of the sheet for a board that speaks frames: from its reset to its silence.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "unit/device/board/board_rig.h"

namespace dts::device::board::test {
namespace {

using core::ErrorCode;
using core::GapReason;

TEST(BoardFrames, Values_AreThoseOfTheBoard) {
  BoardRig rig;
  rig.start(1000.0);
  while (rig.witness->scans < 10'000) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->gaps, 0U);
  EXPECT_EQ(rig.witness->first->counter, 0U) << "from the first scan on";
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, Report_NamesTheBoard) {
  BoardRig rig;
  rig.open();
  const DeviceReport report = rig.device->report();
  EXPECT_EQ(report.serial, "B0A4D001");
  EXPECT_EQ(report.firmware, "1.0");
  EXPECT_EQ(report.nodes, std::vector<std::string>{"/dev/fake"});
  ASSERT_NE(rig.check("describes itself"), nullptr);
  EXPECT_EQ(rig.check("describes itself")->detail, "Fake board, 15 bits, a0, a1, a2, a3");
}

TEST(BoardFrames, OtherNumberOfChannels_IsNamedWithBoth) {
  BoardRig rig({.channels = 6});
  const core::Error error = rig.open_error();
  EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
  EXPECT_EQ(error.what, "cannot open serial:fake?channels=4: the board has 6 channels, the address says channels=4");
}

TEST(BoardFrames, OtherSerial_IsRejected) {
  BoardRig wrong({}, "channels=4&serial=X1");
  const core::Error error = wrong.open_error();
  EXPECT_EQ(error.code, ErrorCode::NotFound);
  EXPECT_NE(error.what.find("the board's serial number is B0A4D001, the address says serial=X1"), std::string::npos) << error.what;
  BoardRig own({}, "channels=4&serial=B0A4D001");
  own.open();
  BoardRig of_adapter({}, "channels=4&serial=USB7");
  of_adapter.link->adapter_serial = "USB7";
  of_adapter.open();
}

TEST(BoardFrames, OtherUnitRangeOrResolution_IsRejected) {
  EXPECT_NE(
      BoardRig({}, "channels=4&unit=mV").open_error().what.find("the board has the unit 'V' on channel 0 (a0), the address says unit=mV"),
      std::string::npos);
  EXPECT_NE(BoardRig({}, "channels=4&range=0,3.3").open_error().what.find("the board has the range 0,5 on channel 0"), std::string::npos);
  EXPECT_NE(BoardRig({}, "channels=4&resolution=0.1").open_error().what.find("steps of"), std::string::npos);
  EXPECT_NE(BoardRig({}, "channels=4&marker=2").open_error().what.find("no constant code on channel 2"), std::string::npos);
  BoardRig({}, "channels=4&range=-10,10&resolution=0.000153").open();
}

TEST(BoardFrames, NoAnswer_SaysWhatCameInstead) {
  BoardRig silent({.starts_on_command = false, .hears = false, .silent_at_s = 0.0});
  EXPECT_EQ(silent.open_error().code, ErrorCode::Timeout);
  BoardRig lines({.speaks_lines = true});
  const core::Error error = lines.open_error();
  EXPECT_EQ(error.code, ErrorCode::DataDamaged);
  EXPECT_NE(error.hint.find("format=lines"), std::string::npos);
}

/// 10,000 garbage texts in the place of frames.
TEST(BoardFrames, WrongBaudRate_GivesNoScan) {
  BoardRig rig;
  rig.link->damage.flip = 0.5;
  EXPECT_EQ(rig.open_error().code, ErrorCode::DataDamaged);
  rig.link->damage.flip = 0.0;
  rig.start(1000.0);
  rig.link->damage.flip = 0.5;
  rig.read_until_trouble(60.0);
  EXPECT_EQ(rig.witness->wrong_values, 0U);
  EXPECT_LE(rig.witness->scans, 10U);
}

TEST(BoardFrames, RateThatTheBoardCannotRun_IsRejectedWithTheOneToConfigure) {
  BoardRig rig({.rate = {16'000'000, 16'001}, .keeps_rate = true});
  rig.open();
  const auto started = rig.device->start({rate_of(1000.0), 64});
  ASSERT_FALSE(started.has_value());
  EXPECT_EQ(started.error().code, ErrorCode::InvalidArgument);
  EXPECT_NE(started.error().what.find("cannot run at 1000 Hz; the nearest is 999.93"), std::string::npos) << started.error().what;
  EXPECT_EQ(started.error().hint, "configure rate_hz = 999.937504");
  EXPECT_FALSE(rig.board->is_streaming());
  const auto again = rig.device->start({rate_of(999.937504), 64});
  EXPECT_TRUE(again.has_value());
}

TEST(BoardFrames, UnknownRate_IsMeasuredBeforeTheStart) {
  for (const bool carries_time : {true, false}) {
    BoardRig rig({.rate = {250, 1}, .carries_time = carries_time, .knows_rate = false, .keeps_rate = true});
    rig.open();
    const DeviceCheck* const check = rig.check("rate was measured");
    ASSERT_NE(check, nullptr);
    EXPECT_NEAR(std::stod(check->detail), 250.0, 0.5);
    const auto wrong = rig.device->start({rate_of(260.0), 64});
    ASSERT_FALSE(wrong.has_value());
    EXPECT_EQ(wrong.error().code, ErrorCode::InvalidArgument);
    rig.start(250.0);
    while (rig.witness->scans < 1000) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
    rig.expect_nothing_hidden();
  }
}

TEST(BoardFrames, BoardThatStartsByItself_NeedsNoCommand) {
  BoardRig rig({.rate = {100, 1}, .starts_on_command = false});
  rig.start(100.0);
  while (rig.witness->scans < 500) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->gaps, 0U);
  rig.expect_nothing_hidden();
  EXPECT_TRUE(rig.device->stop().has_value());
  EXPECT_TRUE(rig.board->is_streaming());
  rig.start(100.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(BoardFrames, BoardThatDoesNotHear_IsLearntFromItsRepetitions) {
  FakeBoardSetup setup{.rate = {100, 1}, .starts_on_command = false, .hears = false};
  BoardRig rig(setup);
  rig.link->resets_on_open = false;
  rig.clock.advance_ns(kSecond);
  rig.start(100.0);
  while (rig.witness->scans < 2000) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->gaps, 0U) << "the same description again is ignored";
}

TEST(BoardFrames, BoardThatStreamsAlready_IsStoppedAndStartedAgain) {
  BoardRig rig;
  rig.start(100.0);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  // Another program comes: the board was never stopped.
  auto uri = DeviceUri::parse("serial:fake?channels=4");
  auto link = std::make_unique<FakeLink>(*rig.board, rig.clock);
  link->resets_on_open = false;
  BoardDevice second(read_board_options(*uri, true).value(), std::move(link), rig.clock);
  const std::uint8_t earlier_run = rig.board->run();
  ASSERT_TRUE(second.open().has_value());
  EXPECT_FALSE(rig.board->is_streaming());
  ASSERT_TRUE(second.start({rate_of(200.0), 64}).has_value());
  Witness witness(4);
  ASSERT_EQ(witness.read(second, rig.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);
  EXPECT_NE(witness.first->run, earlier_run);
  EXPECT_EQ(witness.first->counter, 0U);
}

TEST(BoardFrames, LostScans_AreAnExactGapWithItsReason) {
  BoardRig rig({.loses_at_s = 1.0, .lost_scans = 33});
  rig.start(1000.0);
  const ReadResult gap = rig.read_until_trouble(5.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_EQ(gap.gap.reason, GapReason::Overrun) << "LOST says why";
  EXPECT_EQ(gap.gap.missing_scans, 33U);
  EXPECT_TRUE(gap.gap.is_exact);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->block.first_scan.value, 0U);
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, DamagedFrame_IsAnExactGap) {
  BoardRig rig;
  rig.start(1000.0);
  rig.read();
  rig.link->damage = {.flip = 1.0};
  rig.clock.advance_ns(4 * kMs);
  rig.read(4 * kMs);
  rig.link->damage = {};
  const ReadResult gap = rig.read_until_trouble(5.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_EQ(gap.gap.reason, GapReason::Integrity);
  EXPECT_TRUE(gap.gap.is_exact);
  EXPECT_EQ(gap.gap.missing_scans % 5, 0U) << "whole frames";
  rig.read();
  rig.expect_nothing_hidden();
}

/// The scans before the first delivered one are lost, but not untold.
TEST(BoardFrames, LossBeforeTheFirstScan_IsAnExactGap) {
  BoardRig rig({.loses_at_s = 0.0, .lost_scans = 21});
  rig.start(1000.0);
  const ReadResult gap = rig.read();
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_EQ(gap.gap.missing_scans, 21U);
  EXPECT_TRUE(gap.gap.is_exact);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->first->counter, 21U);
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, Counter_Wraps) {
  BoardRig rig;
  rig.start(1000.0);
  rig.read();
  BoardRig near_wrap;
  near_wrap.open();
  ASSERT_TRUE(near_wrap.device->start({rate_of(1000.0), 64}).has_value());
  near_wrap.board->set_counter(0xFFFFFFFFU - 49U);  // as if the run were 49 days old; the gap before it is what a counter near its end is
  const ReadResult first = near_wrap.read();
  EXPECT_EQ(first.outcome, ReadOutcome::Broken) << "a run that we started begins at 0";
}

TEST(BoardFrames, CounterWrap_InARunningScan_IsNoGap) {
  BoardRig rig({.starts_on_command = false});
  rig.open();
  rig.board->set_counter(0xFFFFFFFFU - 200U);
  rig.start(100.0);
  std::uint64_t scans = 0;
  while (scans < 1000) {
    const ReadResult result = rig.device->read(rig.witness->block, rig.clock.now_ns() + kSecond);
    ASSERT_EQ(result.outcome, ReadOutcome::Scans);
    scans += rig.witness->block.count();
  }
  EXPECT_LT(rig.board->counter(), 2000U) << "it has wrapped";
}

TEST(BoardFrames, CounterThatRunsBackwards_BreaksTheScan) {
  BoardRig rig;
  rig.start(100.0);
  while (rig.witness->scans < 100) rig.read();
  rig.board->set_counter(3);
  const ReadResult broken = rig.read_until_trouble(5.0);
  EXPECT_EQ(broken.outcome, ReadOutcome::Broken);
  EXPECT_EQ(broken.gap.reason, GapReason::Integrity);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.start(100.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(BoardFrames, Reset_IsANewSegmentWithALossFromTime) {
  BoardRig rig;
  rig.start(1000.0);
  for (int i = 0; i < 10; ++i) {
    while (rig.read_until_trouble(1.0).outcome != ReadOutcome::Scans) {
    }
    const std::uint32_t before = rig.board->counter();
    const std::int64_t reset_ns = rig.clock.now_ns();
    rig.board->reset(rig.clock.now_ns());
    const ReadResult gap = rig.read_until_trouble(10.0);
    ASSERT_EQ(gap.outcome, ReadOutcome::Gap) << before;
    EXPECT_FALSE(gap.gap.is_exact);
    ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
    const double away_ms = static_cast<double>(rig.board->run_start_ns() - reset_ns) * 1e-6;
    EXPECT_NEAR(static_cast<double>(gap.gap.missing_scans), away_ms, 7.0) << "and at most one frame that was not whole";
    EXPECT_LE(away_ms, 5.0) << "it is started again as soon as it describes itself";
  }
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, ResetThatNobodySees_IsFoundBySilence) {
  BoardRig rig;
  rig.start(1000.0);
  rig.read();
  rig.board->reset(rig.clock.now_ns());
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();  // its description is lost
  const ReadResult gap = rig.read_until_trouble(10.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_NEAR(static_cast<double>(gap.gap.missing_scans), 1002.0, 30.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(BoardFrames, Silence_IsAskedThenStartedThenGone) {
  BoardRig rig({.silent_at_s = 2.0});
  rig.start(100.0);
  const ReadResult gone = rig.read_until_trouble(60.0);
  EXPECT_EQ(gone.outcome, ReadOutcome::Gone);
  EXPECT_EQ(gone.gap.reason, GapReason::Silence);
  EXPECT_EQ(rig.device->state(), DeviceState::Gone);
  const double silent_s = static_cast<double>(rig.clock.now_ns() - rig.board->run_start_ns()) * 1e-9 - 2.0;
  EXPECT_NEAR(silent_s, 1.02 + 0.5 + 1.02, 0.2);
  EXPECT_TRUE(rig.device->close().has_value());
  EXPECT_TRUE(rig.device->report().nodes.empty()) << "another board may have them now";
  rig.start(100.0);  // opening resets it
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(BoardFrames, Unplugged_IsGone) {
  BoardRig rig;
  rig.start(100.0);
  rig.read();
  rig.link->is_plugged = false;
  const ReadResult gone = rig.read_until_trouble(5.0);
  EXPECT_EQ(gone.outcome, ReadOutcome::Gone);
  EXPECT_EQ(gone.gap.reason, GapReason::Unplugged);
}

TEST(BoardFrames, AnotherDescription_BreaksTheScanAndIsAskedFor) {
  BoardRig rig;
  rig.start(100.0);
  rig.read();
  rig.board->setup().serial = "B0A4D002";
  const ReadResult broken = rig.read_until_trouble(10.0);  // the description every 5 s
  EXPECT_EQ(broken.outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.start(100.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(BoardFrames, Pattern_IsNeverDelivered) {
  BoardRig rig;
  rig.start(100.0);
  rig.read();
  rig.board->receive(pattern_command(true).view(), rig.clock.now_ns());
  const ReadResult broken = rig.read_until_trouble(10.0);
  EXPECT_EQ(broken.outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.start(100.0);
  while (rig.witness->scans < 200) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, PatternBeforeTheStart_IsSwitchedOff) {
  BoardRig rig;
  rig.open();
  rig.board->receive(pattern_command(true).view(), rig.clock.now_ns());
  rig.start(100.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, Stop_SaysHowManyScansFollowed) {
  BoardRig rig;
  rig.start(1000.0);
  while (rig.witness->scans < 640) rig.read();
  rig.clock.advance_ns(100 * kMs);
  rig.board->run_until(rig.clock.now_ns());
  ASSERT_TRUE(rig.device->stop().has_value());
  const DeviceCheck* const check = rig.check("between the last delivered one and the stop");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->detail, std::to_string(rig.board->counter() - rig.witness->scans) + " scans were not delivered");
  EXPECT_GE(rig.board->counter() - rig.witness->scans, 100U);
}

TEST(BoardFrames, Stop_CountsALossThatWasNotReportedYet) {
  BoardRig rig({.loses_at_s = 1.0, .lost_scans = 33});
  rig.start(1000.0);
  do {
    ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  } while (rig.witness->block.count() == 64);  // a block that is not full ends before the loss
  ASSERT_TRUE(rig.device->stop().has_value());
  const DeviceCheck* const check = rig.check("between the last delivered one and the stop");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->detail, std::to_string(rig.board->counter() - rig.witness->scans) + " scans were not delivered");
  EXPECT_GE(rig.board->counter() - rig.witness->scans, 33U);
}

TEST(BoardFrames, StoppedByAButton_ShowsTheTailAndIsStartedAgain) {
  BoardRig rig({.loses_at_s = std::nullopt});
  rig.start(1000.0);
  while (rig.witness->scans < 500) rig.read();
  rig.clock.advance_ns(2 * kMs);
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();  // at least one frame is lost
  rig.clock.advance_ns(20 * kMs);
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();
  rig.clock.advance_ns(kSecond);
  rig.board->drop_output();
  rig.board->receive(stop_command().view(), rig.clock.now_ns());
  const std::uint32_t end = rig.board->counter();
  const ReadResult gap = rig.read_until_trouble(5.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_TRUE(gap.gap.is_exact);
  EXPECT_GT(gap.gap.missing_scans, 0U);
  EXPECT_LE(rig.witness->scans + gap.gap.missing_scans, end);
  std::uint64_t before = rig.witness->scans;
  for (int i = 0; i < 10 && rig.witness->scans == before; ++i) rig.read_until_trouble(5.0);
  EXPECT_GT(rig.witness->scans, before);
}

TEST(BoardFrames, ConstantChannel_BreaksTheScanWhenItIsWrong) {
  BoardRig rig({.constant_channel = 3}, "channels=4&marker=3");
  EXPECT_EQ(rig.device->describe().channels[3].role, ChannelRole::Marker);
  rig.open();
  ASSERT_TRUE(rig.device->start({rate_of(100.0), 64}).has_value());
  ASSERT_EQ(rig.device->read(rig.witness->block, rig.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);
  rig.board->setup().constant_channel = -1;
  ReadResult result;
  for (int i = 0; i < 10 && result.outcome != ReadOutcome::Broken; ++i) {
    result = rig.device->read(rig.witness->block, rig.clock.now_ns() + kSecond);
  }
  EXPECT_EQ(result.outcome, ReadOutcome::Broken);
  EXPECT_EQ(result.gap.reason, GapReason::Integrity);
}

TEST(BoardFrames, CodeOutsideTheRange_IsMarkedAndKept) {
  BoardRig rig({}, "channels=1");
  rig.board->setup().channels = 1;
  rig.start(100.0);
  // A frame of our own: run and counter as the board's next ones.
  std::array<std::uint8_t, 13> scans{3, rig.board->run(), 0, 0, 0, 0, 0, 0, 0, 0, 1, 0xFF, 0xFF};
  rig.board->send_payload(scans);
  const ReadResult result = rig.device->read(rig.witness->block, rig.clock.now_ns() + 1);
  ASSERT_EQ(result.outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->block.quality(0)[0], core::quality::kRail);
  EXPECT_EQ(rig.witness->block.column(0)[0], dts::test::fake_value(-1));
}

TEST(BoardFrames, HostTime_FollowsTheBoardsClock) {
  for (const bool carries_time : {true, false}) {
    for (const double ppm : {0.0, 80.0, -150.0}) {
      BoardRig rig({.carries_time = carries_time, .clock_ppm = ppm});
      rig.start(1000.0);
      double drift_ppm = 0.0;
      std::int64_t error_ns = 0;
      for (const std::int64_t until_ns = rig.clock.now_ns() + 40 * kSecond; rig.clock.now_ns() < until_ns;) {
        ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
        drift_ppm = rig.witness->block.clock_drift_ppm;
        const double period_ns = 1e6 / (1.0 + ppm * 1e-6);
        const double made_ns =
            static_cast<double>(rig.board->run_start_ns()) + static_cast<double>(rig.witness->block.first_scan.value + 1) * period_ns;
        error_ns = rig.witness->block.host_time_ns - static_cast<std::int64_t>(made_ns);
      }
      EXPECT_NEAR(drift_ppm, ppm, 5.0) << carries_time;
      EXPECT_LE(std::abs(error_ns), 100'000) << ppm << carries_time;
    }
  }
}

TEST(BoardFrames, CountedLoss_DoesNotMoveTheTime) {
  BoardRig rig({.clock_ppm = 50.0, .loses_at_s = 20.0, .lost_scans = 500});
  rig.start(1000.0);
  ASSERT_EQ(rig.read_until_trouble(30.0).outcome, ReadOutcome::Gap);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_NEAR(rig.witness->block.clock_drift_ppm, 50.0, 5.0) << "the estimate was not begun again";
  EXPECT_LE(rig.witness->block.host_time_uncertainty_ns, 5 * kMs);
}

TEST(BoardFrames, ScansThatNobodyCounts_BreakTheScan) {
  BoardRig rig;  // carries ticks
  rig.start(1000.0);
  while (rig.witness->scans < 1000) rig.read();
  const std::uint32_t counter = rig.board->counter();
  rig.board->setup().rate = {1000, 1};
  rig.clock.advance_ns(500 * kMs);
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();
  // The board continues where it was: 500 scans later by its ticks, but not by its counter.
  std::array<std::uint8_t, 19> scans{3, rig.board->run()};
  for (unsigned i = 0; i < 4; ++i) scans[2 + i] = static_cast<std::uint8_t>((counter - counter % 5) >> (8 * i));
  const std::uint32_t ticks = 1'500'000 + 1000;
  for (unsigned i = 0; i < 4; ++i) scans[6 + i] = static_cast<std::uint8_t>(ticks >> (8 * i));
  scans[10] = 1;
  rig.board->send_payload(scans);
  const ReadResult broken = rig.device->read(rig.witness->block, rig.clock.now_ns() + 1);
  EXPECT_NE(broken.outcome, ReadOutcome::Timeout);
}

TEST(BoardFrames, WrongRate_BreaksTheScan) {
  BoardRig rig({.carries_time = false, .clock_ppm = 30'000.0});
  rig.start(1000.0);
  const ReadResult broken = rig.read_until_trouble(20.0);
  EXPECT_EQ(broken.outcome, ReadOutcome::Broken);
  EXPECT_EQ(broken.gap.reason, GapReason::Integrity);
}

TEST(BoardFrames, Log_IsInTheReport) {
  BoardRig rig;
  rig.start(100.0);
  rig.board->send_log("brown-out\x1B[2J");
  rig.read();
  ASSERT_TRUE(rig.device->stop().has_value());
  ASSERT_NE(rig.check("newest message"), nullptr);
  EXPECT_EQ(rig.check("newest message")->detail, "brown-out [2J");
}

/// Bit flips, dropped and doubled bytes, 10 resets and 10 replugs: the short form of the fault suite's test.
TEST(BoardFrames, BadLineResetsAndReplugs_HideNothing) {
  BoardRig rig;
  rig.start(1000.0);
  rig.link->damage = {.flip = 1e-4, .drop = 1e-4, .doubled = 1e-4};
  std::uint64_t restarts = 0;
  for (int round = 0; round < 20; ++round) {
    const std::uint64_t until = rig.witness->scans + 5000;
    for (int i = 0; i < 100'000 && rig.witness->scans < until; ++i) {
      const ReadResult result = rig.read();
      if (result.outcome != ReadOutcome::Broken && result.outcome != ReadOutcome::Gone) continue;
      ++restarts;
      (void)rig.device->stop();
      if (rig.device->state() == DeviceState::Gone) {
        (void)rig.device->close();
        rig.link->is_plugged = true;
        for (int attempt = 0; attempt < 10 && !rig.device->open(); ++attempt) {
        }
      }
      for (int attempt = 0; attempt < 10 && !rig.device->start({rate_of(1000.0), 64}); ++attempt) {
      }
    }
    ASSERT_GE(rig.witness->scans, until);
    if (round % 2 == 0) {
      rig.board->reset(rig.clock.now_ns());
    } else {
      rig.link->is_plugged = false;
    }
  }
  rig.expect_nothing_hidden();
  EXPECT_GT(rig.link->damage.count, 100U);
  EXPECT_GT(rig.witness->exact_missing, 100U);
  EXPECT_GE(restarts, 9U);  // the last one is only unplugged
}

}  // namespace
}  // namespace dts::device::board::test
