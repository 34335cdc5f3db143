// SPDX-License-Identifier: Apache-2.0
// The rules of the sheet for a board that writes lines of numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "unit/device/board/board_rig.h"

namespace dts::device::board::test {
namespace {

using core::ErrorCode;

const std::string kLines = "channels=4&format=lines&rate_hz=100";

void send(BoardRig& rig, std::string_view text) {
  rig.board->send_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(BoardLines, Values_AreThoseOfTheBoard) {
  for (const std::string_view separator : {",", "\t", " "}) {
    for (const std::string_view end : {"\n", "\r\n"}) {
      for (const bool has_checksum : {false, true}) {
        BoardRig rig({.speaks_lines = true, .has_checksum = has_checksum, .separator = separator, .line_end = end}, kLines);
        rig.start();
        while (rig.witness->scans < 300) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
        EXPECT_EQ(rig.witness->gaps, 0U);
        rig.expect_nothing_hidden();
      }
    }
  }
}

TEST(BoardLines, OtherNumberOfColumns_IsNamedWithBoth) {
  BoardRig rig({.speaks_lines = true, .channels = 3}, kLines);
  const core::Error error = rig.open_error();
  EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
  EXPECT_NE(error.what.find("the board's lines have 3 columns, the address says 4"), std::string::npos) << error.what;
}

TEST(BoardLines, FramesOrNothing_AreSaid) {
  BoardRig frames({.starts_on_command = false}, kLines);
  EXPECT_EQ(frames.open_error().code, ErrorCode::DataDamaged);
  BoardRig nothing({.speaks_lines = true, .silent_at_s = 0.0}, kLines);
  EXPECT_EQ(nothing.open_error().code, ErrorCode::Timeout);
}

TEST(BoardLines, CountedLoss_IsExact) {
  for (const unsigned bits : {16U, 32U}) {
    BoardRig rig({.speaks_lines = true, .has_counter = true, .counter_bits = bits, .loses_at_s = 3.0, .lost_scans = 21},
                 kLines + "&counter=1&counter_bits=" + std::to_string(bits));
    rig.start();
    const ReadResult gap = rig.read_until_trouble(10.0);
    ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
    EXPECT_TRUE(gap.gap.is_exact);
    EXPECT_EQ(gap.gap.missing_scans, 21U);
    while (rig.witness->scans < 600) rig.read();
    EXPECT_EQ(rig.witness->gaps, 1U);
    rig.expect_nothing_hidden();
  }
}

TEST(BoardLines, CounterOf16Bits_Wraps) {
  BoardRig rig({.speaks_lines = true, .has_counter = true, .counter_bits = 16}, kLines + "&counter=1&counter_bits=16");
  rig.open();
  rig.board->set_counter(65'000);
  rig.start();
  while (rig.witness->scans < 1000) ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->gaps, 0U);
}

TEST(BoardLines, BadLine_IsOneLostScan) {
  for (const bool has_counter : {true, false}) {
    BoardRig rig({.speaks_lines = true, .has_counter = has_counter}, kLines + (has_counter ? "&counter=1" : ""));
    rig.start();
    while (rig.witness->scans < 100) rig.read();
    rig.link->damage = {.flip = 1.0};
    rig.read(12 * kMs);
    rig.link->damage = {};
    const ReadResult gap = rig.read_until_trouble(5.0);
    ASSERT_EQ(gap.outcome, ReadOutcome::Gap) << has_counter;
    EXPECT_EQ(gap.gap.is_exact, has_counter);
    EXPECT_GE(gap.gap.missing_scans, 1U);
    EXPECT_LE(gap.gap.missing_scans, 3U);
    rig.read();
    rig.expect_nothing_hidden();
  }
}

TEST(BoardLines, DamagedDigitOfTheCounter_IsNoLargeLoss) {
  BoardRig rig({.speaks_lines = true, .has_counter = true}, kLines + "&counter=1");
  rig.start();
  while (rig.witness->scans < 100) rig.read();
  send(rig, "4000000,1,1,1,1\n");
  for (int i = 0; i < 10; ++i) rig.read();
  EXPECT_EQ(rig.witness->wrong_values, 0U) << "the damaged line is not used";
  EXPECT_LE(rig.witness->exact_missing, 1U);
  rig.expect_nothing_hidden();
}

/// The digit makes the counter a little larger, so it looks like a short loss.
TEST(BoardLines, DamagedDigitALittleAhead_IsNoLoss) {
  for (const unsigned ahead : {1U, 9U, 60U}) {
    BoardRig rig({.speaks_lines = true, .has_counter = true}, kLines + "&counter=1");
    rig.start();
    while (rig.witness->scans < 100) rig.read();
    send(rig, std::to_string(rig.board->counter() + ahead) + ",1,1,1,1\n");
    for (int i = 0; i < 40; ++i) rig.read(50 * kMs);
    EXPECT_EQ(rig.witness->gaps, 0U) << "nothing is lost";
    rig.expect_nothing_hidden();
  }
}

/// Lines that arrive earlier than the time of their scans allows, as after a change of the host's clock: two of them agree.
TEST(BoardLines, CounterAheadOfTime_IsExactWhenTheNextLineAgrees) {
  BoardRig rig({.speaks_lines = true, .has_counter = true}, kLines + "&counter=1");
  rig.start();
  while (rig.witness->scans < 100) rig.read();
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();
  const std::uint64_t last = rig.board->counter() - 1;
  rig.board->setup().silent_at_s = 0.0;
  send(rig, std::to_string(last + 31) + ",1,1,1,1\n" + std::to_string(last + 32) + ",1,1,1,1\n");
  const ReadResult gap = rig.device->read(rig.witness->block, rig.clock.now_ns() + 1);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_TRUE(gap.gap.is_exact);
  EXPECT_EQ(gap.gap.missing_scans, 31U) << "and the line that the next one had to confirm";
}

TEST(BoardLines, PauseOfMoreThanHalfATurn_IsNotExact) {
  for (const int seconds : {20, 40, 70}) {  // half a turn of 16 bits is 33 s
    BoardRig rig({.speaks_lines = true, .rate = {1000, 1}, .has_counter = true, .counter_bits = 16},
                 "channels=4&format=lines&rate_hz=1000&counter=1&counter_bits=16");
    rig.start(1000.0);
    while (rig.witness->scans < 1000) rig.read();
    const std::uint32_t before = rig.board->counter();
    for (int i = 0; i < seconds * 10; ++i) {
      rig.clock.advance_ns(100 * kMs);
      rig.board->run_until(rig.clock.now_ns());
      rig.board->drop_output();
    }
    const ReadResult gap = rig.read_until_trouble(5.0);
    ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
    EXPECT_EQ(gap.gap.is_exact, seconds < 33) << seconds;
    EXPECT_NEAR(static_cast<double>(gap.gap.missing_scans), static_cast<double>(rig.board->counter() - before), 20.0) << seconds;
    rig.read();
    EXPECT_EQ(rig.witness->wrong_counts, 0U);
  }
}

TEST(BoardLines, Reset_IsANewSegment) {
  BoardRig rig({.speaks_lines = true, .has_counter = true}, kLines + "&counter=1");
  rig.start();
  while (rig.witness->scans < 1000) rig.read();
  rig.clock.advance_ns(500 * kMs);
  rig.board->reset(rig.clock.now_ns());
  const ReadResult gap = rig.read_until_trouble(5.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_FALSE(gap.gap.is_exact);
  EXPECT_NEAR(static_cast<double>(gap.gap.missing_scans), 51.0, 3.0) << "and the line that the next one had to confirm";
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.witness->wrong_values, 0U);
  EXPECT_EQ(rig.witness->hidden_losses, 0U);
}

/// An interrupt that is left from the last scan does not keep old lines.
TEST(BoardLines, StartAfterAnInterrupt_BeginsWithNewLines) {
  BoardRig rig({.speaks_lines = true, .has_counter = true}, "channels=4&format=lines&rate_hz=100&counter=1");
  rig.start();
  while (rig.witness->scans < 100) rig.read();
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.clock.advance_ns(3 * kSecond);
  rig.board->run_until(rig.clock.now_ns());
  const std::uint32_t counter = rig.board->counter();
  rig.device->interrupt();
  rig.start();
  rig.witness->first.reset();
  while (!rig.witness->first) rig.read();
  EXPECT_GE(rig.witness->first->counter, counter);
}

TEST(BoardLines, TimeInTheLines_ShowsTheLoss) {
  BoardRig rig({.speaks_lines = true, .has_time = true, .loses_at_s = 3.0, .lost_scans = 9}, kLines + "&time_us=1");
  rig.start();
  const ReadResult gap = rig.read_until_trouble(10.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_FALSE(gap.gap.is_exact);
  EXPECT_EQ(gap.gap.missing_scans, 9U);
}

/// A board whose lines have a time, in the hands of the test.
struct TimedLines {
  TimedLines() {
    rig.board->setup().has_time = true;
    rig.open();
    EXPECT_TRUE(rig.device->start({rate_of(100.0), 64}).has_value());
    rig.clock.advance_ns(kSecond);
    rig.board->run_until(rig.clock.now_ns());
    rig.board->drop_output();
    board::test::send(rig, "cut\n");
  }
  /// 10 ms pass; sends a line unless it `is_lost`.
  void step(int late_us = 0, bool is_lost = false) {
    rig.clock.advance_ns(10 * kMs);
    time_us += 10'000;
    if (!is_lost) board::test::send(rig, std::to_string(time_us + late_us) + ",1.5\n");
    ReadResult result;
    do {
      result = rig.device->read(rig.witness->block, rig.clock.now_ns());
      scans += rig.witness->block.count();
      if (result.outcome == ReadOutcome::Gap) {
        ++gaps;
        missing += result.gap.missing_scans;
      }
      is_broken = is_broken || result.outcome == ReadOutcome::Broken;
    } while (result.outcome != ReadOutcome::Timeout && !is_broken);
  }

  BoardRig rig{{.speaks_lines = true, .channels = 1, .silent_at_s = 0.5}, "channels=1&format=lines&rate_hz=100&time_us=1"};
  std::uint32_t time_us = 4'290'000'000U;  // it wraps after 5 s
  std::uint64_t scans = 0;
  std::uint64_t gaps = 0;
  std::uint64_t missing = 0;
  bool is_broken = false;
};

TEST(BoardLines, JitterOfTheTimeInTheLines_IsNoLoss) {
  for (const int late_us : {5200, 7000, -5200}) {
    TimedLines lines;
    for (int i = 0; i < 2000; ++i) lines.step(i % 20 == 0 ? late_us : 0);
    EXPECT_EQ(lines.gaps, 0U) << late_us;
    EXPECT_FALSE(lines.is_broken) << late_us;
    EXPECT_GE(lines.scans, 1999U);
  }
}

TEST(BoardLines, LossAmongJitter_IsShownByTheTimeInTheLines) {
  TimedLines lines;
  for (int i = 0; i < 2000; ++i) lines.step(i % 7 == 0 ? 2000 : 0, i % 500 == 250);
  EXPECT_EQ(lines.gaps, 4U);
  EXPECT_EQ(lines.missing, 4U);
  EXPECT_FALSE(lines.is_broken);
}

/// The board's crystal may be bad: the time is still no loss.
TEST(BoardLines, DriftOfTheTimeInTheLines_IsNoLoss) {
  TimedLines lines;
  for (int i = 0; i < 3000; ++i) {
    lines.time_us += i % 2 == 0 ? 100 : 0;  // 0.5 % slow
    lines.step();
  }
  EXPECT_EQ(lines.gaps, 0U);
  EXPECT_FALSE(lines.is_broken);
}

TEST(BoardLines, ForeignLine_IsNoLossIfTheTimeShowsNone) {
  TimedLines lines;
  for (int i = 0; i < 300; ++i) {
    lines.step();
    if (i == 100) send(lines.rig, "# battery low\n");
  }
  EXPECT_EQ(lines.gaps, 0U);
  send(lines.rig, std::to_string(lines.time_us + 10'000) + ",\n1.5\n");  // a line that a stray LF has cut in two
  lines.step(0, true);
  for (int i = 0; i < 3; ++i) lines.step();
  EXPECT_EQ(lines.gaps, 1U);
  EXPECT_EQ(lines.missing, 1U);
}

TEST(BoardLines, LossWithoutCounter_IsFoundWithin3Seconds) {
  for (const double ppm : {0.0, -5000.0}) {
    BoardRig rig({.speaks_lines = true, .clock_ppm = ppm, .loses_at_s = 5.0, .lost_scans = 5}, kLines);
    rig.start();
    const std::int64_t start_ns = rig.board->run_start_ns();
    const ReadResult gap = rig.read_until_trouble(20.0);
    ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
    EXPECT_FALSE(gap.gap.is_exact);
    const double doubt_scans = ppm == 0.0 ? 1.0 : 5.0;  // the drift is not known yet
    EXPECT_NEAR(static_cast<double>(gap.gap.missing_scans), 5.0, doubt_scans) << ppm;
    EXPECT_LE(static_cast<double>(rig.clock.now_ns() - start_ns) * 1e-9, 5.0 + 3.2) << ppm;
  }
}

/// An Arduino Uno has a ceramic resonator.
TEST(BoardLines, SlowClockWithoutCounter_IsDriftAndNoLoss) {
  for (const double rate_hz : {50.0, 100.0, 500.0}) {
    for (const double ppm : {-600.0, -1000.0, -5000.0, -9000.0}) {
      BoardRig rig({.speaks_lines = true, .rate = {static_cast<std::uint32_t>(rate_hz), 1}, .clock_ppm = ppm},
                   "channels=4&format=lines&rate_hz=" + std::to_string(static_cast<int>(rate_hz)));
      rig.start(rate_hz);
      rig.read_until_trouble(60.0);
      EXPECT_EQ(rig.witness->gaps, 0U) << rate_hz << " Hz, " << ppm;
      EXPECT_NEAR(rig.witness->block.clock_drift_ppm, ppm, 100.0) << rate_hz << " Hz";
    }
  }
}

TEST(BoardLines, ValueOutsideTheRange_IsMarkedAndKept) {
  BoardRig rig({.speaks_lines = true, .channels = 1, .silent_at_s = 0.5}, "channels=1&format=lines&rate_hz=100&range=0,1023&unit=counts");
  rig.open();
  ASSERT_TRUE(rig.device->start({rate_of(100.0), 64}).has_value());
  rig.clock.advance_ns(kSecond);
  rig.board->run_until(rig.clock.now_ns());
  rig.board->drop_output();
  send(rig, "cut\n512\n2000\n");
  ASSERT_EQ(rig.device->read(rig.witness->block, rig.clock.now_ns() + 1).outcome, ReadOutcome::Scans);
  ASSERT_GE(rig.witness->block.count(), 2U);
  const std::size_t last = rig.witness->block.count() - 1;
  EXPECT_EQ(rig.witness->block.column(0)[last], 2000.0);
  EXPECT_EQ(rig.witness->block.quality(0)[last], core::quality::kRail);
  EXPECT_EQ(rig.witness->block.quality(0)[last - 1], 0);
  const DeviceCheck* const check = rig.check("values are inside the range");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->outcome, DeviceCheck::Outcome::Warning);
  EXPECT_EQ(check->detail.substr(0, 5), "1 of ") << check->detail;
}

TEST(BoardLines, Silence_IsGone) {
  BoardRig rig({.speaks_lines = true, .silent_at_s = 1.0}, kLines);
  rig.start();
  const ReadResult gone = rig.read_until_trouble(20.0);
  EXPECT_EQ(gone.outcome, ReadOutcome::Gone);
  EXPECT_EQ(gone.gap.reason, core::GapReason::Silence);
}

}  // namespace
}  // namespace dts::device::board::test
