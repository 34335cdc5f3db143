// SPDX-License-Identifier: Apache-2.0
// The rules of the sheet for a board that speaks frames: from its reset to its silence.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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
  EXPECT_FALSE(report.model.empty());
  EXPECT_EQ(report.firmware, "1.0");
  EXPECT_EQ(report.nodes, std::vector<std::string>{"/dev/fake"});
  ASSERT_NE(rig.check("describes itself"), nullptr);
  EXPECT_EQ(rig.check("describes itself")->detail, "Fake board, 15 bits, a0, a1, a2, a3");
}

TEST(BoardFrames, DigitalChannel_HasNoUnitAndTheReportSaysSo) {
  BoardRig rig({.digital_channel = 2});
  rig.open();
  ASSERT_NE(rig.check("describes itself"), nullptr);
  EXPECT_EQ(rig.check("describes itself")->detail, "Fake board, 15 bits, a0, a1, a2 (digital, so its unit is not V), a3");
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
  RecordProperty("requirement", "ACQ-19");
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

/// Two frames in one read, and then nothing: that is no rate.
TEST(BoardFrames, UnknownRateOfABoardThatFallsSilent_IsNotMeasured) {
  BoardRig rig({.rate = {1000, 1},
                .scans_per_frame = 10,
                .carries_time = false,
                .starts_on_command = false,
                .knows_rate = false,
                .silent_at_s = 0.0205});
  rig.link->reads_late_ns = 30 * kMs;
  EXPECT_EQ(rig.open_error().code, ErrorCode::Timeout);
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

/// A button starts the board, and nobody hears that: its scans are not ours.
TEST(BoardFrames, BoardThatAButtonStarted_BeginsAtZero) {
  BoardRig rig;
  rig.open();
  rig.board->receive(start_command({1000, 1}).view(), rig.clock.now_ns());
  rig.clock.advance_ns(20 * kSecond);
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();
  rig.start(1000.0);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->first->counter, 0U);
}

/// A run that is noise equals the last one in 1 of 256 resets.
TEST(BoardFrames, SameRunAfterAReset_IsNotTakenForTheOldOne) {
  BoardRig rig;
  rig.start(1000.0);
  while (rig.witness->scans < 1000) rig.read();
  const std::uint8_t run = rig.board->run();
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.board->reset(rig.clock.now_ns());
  rig.board->set_run(static_cast<std::uint8_t>(run - 1));  // START makes the next one
  rig.start(1000.0);
  EXPECT_EQ(rig.board->run(), run);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  rig.expect_nothing_hidden();
}

/// Noise on the line before a command does not spoil it.
TEST(BoardFrames, CommandBehindNoise_IsUnderstood) {
  BoardRig rig;
  rig.open();
  const std::array<std::uint8_t, 3> noise{5, 6, 7};
  rig.board->receive(noise, rig.clock.now_ns());
  rig.board->receive(start_command({}).view(), rig.clock.now_ns());
  EXPECT_TRUE(rig.board->is_streaming());
}

TEST(BoardFrames, LostScans_AreAnExactGapWithItsReason) {
  RecordProperty("requirement", "ACQ-14");
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

/// LOST is the reason of the gap that it is in, and of no other.
TEST(BoardFrames, ReasonOfALostFrame_IsNotThatOfALaterGap) {
  for (const std::uint32_t ahead : {0U, 30U}) {  // LOST may come before scans that the board still has
    BoardRig rig;
    rig.start(1000.0);
    while (rig.witness->scans < 640 || rig.board->counter() % 5 != 0) rig.read(kMs);
    rig.board->send_lost(LostReason::BufferFull, 0, ahead);
    while (rig.witness->scans < 5000) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
    rig.clock.advance_ns(20 * kMs);
    rig.board->run_until(rig.clock.now_ns());
    rig.board->drop_output();
    const ReadResult gap = rig.read_until_trouble(5.0);
    ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
    EXPECT_EQ(gap.gap.reason, GapReason::Integrity) << ahead;
    rig.expect_nothing_hidden();
  }
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

TEST(BoardFrames, CounterNearItsWrap_AtTheStart_BreaksTheScan) {
  BoardRig rig;
  rig.open();
  ASSERT_TRUE(rig.device->start({rate_of(1000.0), 64}).has_value());
  rig.board->set_counter(0xFFFFFFFFU - 49U);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Broken) << "a run that we started begins at 0";
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

TEST(BoardFrames, SilenceOfABoardThatDoesNotKnowItsRate_Is3Seconds) {
  BoardRig rig({.knows_rate = false, .keeps_rate = true, .silent_at_s = 5.0});
  rig.start(100.0);
  EXPECT_EQ(rig.read_until_trouble(60.0).outcome, ReadOutcome::Gone);
  const double silent_s = static_cast<double>(rig.clock.now_ns() - rig.board->run_start_ns()) * 1e-9 - 5.0;
  EXPECT_NEAR(silent_s, 3.0 + 0.5 + 3.0, 0.2);
}

/// Descriptions and messages are no scans: nothing could be measured with them.
TEST(BoardFrames, FramesWithoutScans_AreSilence) {
  BoardRig rig({.silent_at_s = 2.0});
  rig.start(100.0);
  const std::int64_t start_ns = rig.board->run_start_ns();
  ReadResult result;
  for (int i = 0; i < 600 && result.outcome != ReadOutcome::Gone; ++i) {
    result = rig.read(10 * kMs);
    rig.board->send_descriptor();
    rig.board->send_log("still here");
  }
  EXPECT_EQ(result.outcome, ReadOutcome::Gone);
  EXPECT_EQ(result.gap.reason, GapReason::Silence);
  EXPECT_NEAR(static_cast<double>(rig.clock.now_ns() - start_ns) * 1e-9, 2.0 + 1.02 + 0.5 + 1.02, 0.2);
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

/// The board behind the port is another one: each start checks it as `open` does.
TEST(BoardFrames, AnotherSerialAfterAReset_IsNotStarted) {
  BoardRig rig({}, "channels=4&serial=B0A4D001");
  rig.start(100.0);
  rig.read();
  rig.board->setup().serial = "B0A4D002";
  rig.board->reset(rig.clock.now_ns());
  EXPECT_EQ(rig.read_until_trouble(10.0).outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  for (int attempt = 0; attempt < 2; ++attempt) {
    const auto started = rig.device->start({rate_of(100.0), 64});
    ASSERT_FALSE(started.has_value());
    EXPECT_EQ(started.error().code, ErrorCode::NotFound);
    EXPECT_EQ(rig.device->state(), DeviceState::Open);
  }
  EXPECT_FALSE(rig.board->is_streaming());
  rig.board->setup().serial = "B0A4D001";
  rig.start(100.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(BoardFrames, OtherNumberOfChannelsAfterAReset_IsNotStarted) {
  BoardRig rig;
  rig.start(100.0);
  rig.read();
  rig.board->setup().channels = 6;
  rig.board->reset(rig.clock.now_ns());
  EXPECT_EQ(rig.read_until_trouble(10.0).outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  const auto started = rig.device->start({rate_of(100.0), 64});
  ASSERT_FALSE(started.has_value());
  EXPECT_EQ(started.error().code, ErrorCode::InvalidArgument);
  EXPECT_NE(started.error().what.find("the board has 6 channels"), std::string::npos) << started.error().what;
}

TEST(BoardFrames, OtherScaleWhileItScans_IsNotStarted) {
  BoardRig rig;
  rig.start(100.0);
  rig.read();
  rig.board->setup().scale = 1000.0F;
  rig.board->send_channels();
  EXPECT_EQ(rig.read_until_trouble(10.0).outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  const auto started = rig.device->start({rate_of(100.0), 64});
  ASSERT_FALSE(started.has_value());
  EXPECT_NE(started.error().what.find("the board has the range"), std::string::npos) << started.error().what;
}

/// Nobody reads an open board: its new description waits, or was lost.
TEST(BoardFrames, AnotherBoardBeforeTheStart_IsAskedForItsChannels) {
  for (const bool is_lost : {false, true}) {
    BoardRig rig({}, "channels=4");
    rig.open();
    rig.board->setup().serial = "B0A4D002";
    rig.board->setup().scale = 1000.0F;
    if (!is_lost) rig.board->reset(rig.clock.now_ns());
    const auto started = rig.device->start({rate_of(100.0), 64});
    ASSERT_FALSE(started.has_value());
    EXPECT_NE(started.error().what.find("the board has the range"), std::string::npos) << started.error().what;
    EXPECT_FALSE(rig.board->is_streaming());
    rig.board->setup().scale = 5.0F / 32767.0F;
    rig.start(100.0);
    EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
    EXPECT_EQ(rig.device->report().serial, "B0A4D002");
    rig.expect_nothing_hidden();
  }
}

TEST(BoardFrames, OtherScaleBeforeTheStart_IsFoundInWhatWaits) {
  BoardRig rig;
  rig.open();
  rig.board->setup().scale = 1000.0F;
  rig.board->reset(rig.clock.now_ns());
  EXPECT_FALSE(rig.device->start({rate_of(100.0), 64}).has_value());
}

TEST(BoardFrames, DescriptionThatIsRejected_BreaksTheScanAndIsNamed) {
  const std::array<std::string, 2> fields{"CHANNEL 0: scale is not finite", "DESCRIPTOR: version 2 is unknown"};
  for (const std::string& field : fields) {
    BoardRig rig;
    rig.start(100.0);
    rig.read();
    if (field == fields[0]) rig.board->setup().scale = std::numeric_limits<float>::quiet_NaN();
    if (field == fields[1]) rig.board->setup().version = 2;
    rig.board->send_descriptor();
    rig.board->send_channels();
    EXPECT_EQ(rig.read_until_trouble(4.0).outcome, ReadOutcome::Broken) << field;
    (void)rig.device->stop();  // dtsd does not understand an answer of version 2
    const auto started = rig.device->start({rate_of(100.0), 64});
    ASSERT_FALSE(started.has_value()) << field;
    EXPECT_EQ(started.error().code, ErrorCode::DataDamaged);
    EXPECT_NE(started.error().what.find(field), std::string::npos) << started.error().what;
  }
}

/// A frame of the wrong length says nothing about the board: it is only counted.
TEST(BoardFrames, DescriptionOfTheWrongLength_IsDroppedAndCounted) {
  BoardRig rig;
  rig.start(100.0);
  rig.read();
  rig.board->send_payload(std::array<std::uint8_t, 3>{0x01, 1, 4});
  rig.board->send_payload(std::array<std::uint8_t, 3>{0x02, 0, 0});
  rig.board->send_payload(std::array<std::uint8_t, 123>{0x05});
  while (rig.witness->scans < 200) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  ASSERT_NE(rig.check("arrive undamaged"), nullptr);
  EXPECT_NE(rig.check("arrive undamaged")->detail.find("3 rejected"), std::string::npos) << rig.check("arrive undamaged")->detail;
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

/// Only LOST 4 shows the tail; the new run adds nothing but the time that the board did not scan.
TEST(BoardFrames, TailBeforeAButton_IsToldByItsLostFrameOnce) {
  BoardRig rig;
  rig.start(1000.0);
  while (rig.witness->scans < 2000) rig.read();
  for (int i = 0; i < 50; ++i) {
    rig.clock.advance_ns(10 * kMs);
    rig.board->run_until(rig.clock.now_ns());
    rig.board->drop_output();
  }
  rig.board->receive(stop_command().view(), rig.clock.now_ns());
  const std::uint32_t end = rig.board->counter();
  const std::int64_t stop_ns = rig.clock.now_ns();
  rig.board->drop_output();  // with the scans that STOP has sent
  rig.board->send_lost(LostReason::Stopped, 0);
  rig.board->send_descriptor();
  const ReadResult tail = rig.read_until_trouble(5.0);
  ASSERT_EQ(tail.outcome, ReadOutcome::Gap);
  EXPECT_TRUE(tail.gap.is_exact);
  EXPECT_EQ(tail.gap.missing_scans, end - rig.witness->scans);
  const ReadResult pause = rig.read_until_trouble(5.0);
  ASSERT_EQ(pause.outcome, ReadOutcome::Gap);
  EXPECT_FALSE(pause.gap.is_exact);
  const double pause_ms = static_cast<double>(rig.board->run_start_ns() - stop_ns) * 1e-6;
  EXPECT_NEAR(static_cast<double>(pause.gap.missing_scans), pause_ms, 7.0) << "the tail is not reported twice";
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  rig.expect_nothing_hidden();
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
  ASSERT_NE(rig.check("break off"), nullptr);
  EXPECT_EQ(rig.check("break off")->outcome, DeviceCheck::Outcome::Failed);
  EXPECT_NE(rig.check("break off")->detail.find("constant"), std::string::npos);
  EXPECT_TRUE(rig.device->stop().has_value());
  ASSERT_NE(rig.check("break off"), nullptr);
  EXPECT_EQ(rig.check("break off")->outcome, DeviceCheck::Outcome::Failed);
}

/// A scan that breaks off is started again within milliseconds: its reason must not be gone by then.
TEST(BoardFrames, ReasonOfABrokenScan_StaysInTheReport) {
  BoardRig rig;
  rig.start(100.0);
  EXPECT_EQ(rig.check("break off"), nullptr);
  while (rig.witness->scans < 100) rig.read();
  rig.board->set_counter(3);
  ASSERT_EQ(rig.read_until_trouble(5.0).outcome, ReadOutcome::Broken);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.start(100.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  const DeviceCheck* const check = rig.check("break off");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->outcome, DeviceCheck::Outcome::Warning);
  EXPECT_NE(check->detail.find("the counter of the board runs backwards"), std::string::npos) << check->detail;
  EXPECT_TRUE(rig.device->close().has_value());
  rig.open();
  EXPECT_EQ(rig.check("break off"), nullptr);
}

/// The board continues where it was: 500 scans later by its ticks, but not by its counter.
TEST(BoardFrames, ScansThatNobodyCounts_AreInTheReport) {
  BoardRig rig;  // carries ticks
  rig.start(1000.0);
  while (rig.witness->scans < 1000) rig.read();
  rig.clock.advance_ns(500 * kMs);
  rig.board->skip_uncounted(500);
  ReadResult broken;
  for (int i = 0; i < 10 && broken.outcome != ReadOutcome::Broken; ++i) broken = rig.read();
  EXPECT_EQ(broken.outcome, ReadOutcome::Broken);
  ASSERT_NE(rig.check("break off"), nullptr);
  EXPECT_NE(rig.check("break off")->detail.find("ticks"), std::string::npos) << rig.check("break off")->detail;
  rig.expect_nothing_hidden();
}

TEST(BoardFrames, WhyGone_SaysWhatCameInstead) {
  BoardRig silent({.silent_at_s = 2.0});
  silent.start(100.0);
  EXPECT_EQ(silent.read_until_trouble(60.0).outcome, ReadOutcome::Gone);
  EXPECT_NE(silent.device->why_gone().find("the board is silent"), std::string::npos) << silent.device->why_gone();
  BoardRig garbage;
  garbage.start(100.0);
  garbage.read();
  garbage.link->damage.flip = 0.5;
  EXPECT_EQ(garbage.read_until_trouble(60.0).outcome, ReadOutcome::Gone);
  EXPECT_NE(garbage.device->why_gone().find("what arrives are no frames"), std::string::npos) << garbage.device->why_gone();
  BoardRig other;
  other.start(100.0);
  other.read();
  other.board->setup().channels = 5;  // it does not say so
  other.link->takes_bytes = false;
  EXPECT_EQ(other.read_until_trouble(4.0).outcome, ReadOutcome::Gone);
  EXPECT_NE(other.device->why_gone().find("the board sends frames, but no scans"), std::string::npos) << other.device->why_gone();
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

/// Starts a board whose clock is 80 ppm fast until the drift is known, then another one. Returns the drift that is published first.
double drift_of_the_next_board(const std::string& first_serial, const std::string& next_serial) {
  BoardRig rig({.clock_ppm = 80.0, .serial = first_serial});
  rig.start(1000.0);
  for (const std::int64_t until_ns = rig.clock.now_ns() + 20 * kSecond; rig.clock.now_ns() < until_ns;) rig.read();
  EXPECT_NEAR(rig.witness->block.clock_drift_ppm, 80.0, 20.0);
  EXPECT_TRUE(rig.device->close().has_value());
  rig.board->setup().serial = next_serial;
  rig.board->setup().clock_ppm = -80.0;
  rig.start(1000.0);
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  return rig.witness->block.clock_drift_ppm;
}

TEST(BoardFrames, DriftIsKept_OnlyForABoardWithTheSameSerialNumber) {
  EXPECT_NE(drift_of_the_next_board("A", "A"), 0.0);
  EXPECT_EQ(drift_of_the_next_board("A", "B"), 0.0);
  EXPECT_EQ(drift_of_the_next_board("", ""), 0.0) << "it may be another board";
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
  ReadResult broken;
  for (int i = 0; i < 5 && broken.outcome != ReadOutcome::Broken; ++i) {
    broken = rig.device->read(rig.witness->block, rig.clock.now_ns() + 1);
  }
  EXPECT_EQ(broken.outcome, ReadOutcome::Broken);
  EXPECT_EQ(broken.gap.reason, GapReason::Integrity);
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
  ASSERT_NE(rig.check("newest message"), nullptr) << "while scans flow";
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
