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

TEST(BoardLines, LossWithoutCounter_IsFoundWithin3Seconds) {
  BoardRig rig({.speaks_lines = true, .loses_at_s = 5.0, .lost_scans = 5}, kLines);
  rig.start();
  const std::int64_t start_ns = rig.board->run_start_ns();
  const ReadResult gap = rig.read_until_trouble(20.0);
  ASSERT_EQ(gap.outcome, ReadOutcome::Gap);
  EXPECT_FALSE(gap.gap.is_exact);
  EXPECT_NEAR(static_cast<double>(gap.gap.missing_scans), 5.0, 1.0);
  EXPECT_LE(static_cast<double>(rig.clock.now_ns() - start_ns) * 1e-9, 5.0 + 3.2);
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
