// SPDX-License-Identifier: Apache-2.0
#include "firmware/board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "unit/firmware/fake_hardware.h"
#include "unit/firmware/frames.h"

namespace firmware::test {
namespace {

using ::testing::ElementsAre;

constexpr uint8_t kPattern = 0x04;
constexpr uint8_t kStreaming = 0x08;

class BoardTest : public ::testing::Test {
 protected:
  /// Gives a command and returns what the board sends until it has nothing more.
  std::vector<Bytes> command(const Bytes& payload) {
    for (const uint8_t byte : encoded(payload)) board_.from_host.add(byte);
    board_.from_host.publish();
    return polled();
  }
  std::vector<Bytes> polled() {
    std::vector<Bytes> frames;
    for (int i = 0; i < 50; ++i) {
      board_.poll();
      for (Bytes& frame : take_frames(board_.to_host)) frames.push_back(std::move(frame));
    }
    return frames;
  }
  std::vector<Bytes> start(uint32_t numerator = 0, uint32_t denominator = 1) {
    Bytes payload = {0x82};
    for (const uint32_t value : {numerator, denominator}) {
      const Bytes bytes = u32_bytes(value);
      payload.insert(payload.end(), bytes.begin(), bytes.end());
    }
    return command(payload);
  }
  /// What the converter's interrupt does at each scan.
  void sample(int scans) {
    for (int i = 0; i < scans; ++i, ++next_code_) {
      int16_t* const slot = board_.scans.slot();
      if (slot == nullptr) {
        board_.scans.lose(1, Reason::kBufferFull);
        continue;
      }
      slot[0] = next_code_;
      slot[1] = static_cast<int16_t>(-next_code_);
      board_.scans.commit();
    }
  }
  /// The flags of a descriptor.
  static uint8_t flags(const Bytes& descriptor) { return descriptor.at(16); }

  FakeHardware hardware_;
  Board<FakeHardware> board_{hardware_};
  int16_t next_code_ = 0;
};

TEST_F(BoardTest, AfterAResetItEndsTheOldFrameAndDescribesItself) {
  board_.begin();
  EXPECT_FALSE(board_.to_host.is_empty());
  EXPECT_EQ(board_.to_host.take(), 0);
  const auto frames = polled();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_THAT(frames[0], ElementsAre(0x01, 1, 2, 10, 0x80, 0x84, 0x1E, 0, 0xD0, 0x07, 0, 0, 0x80, 0x84, 0x1E, 0, 0x03,  //
                                     6, 'u', 'n', 'i', 't', '-', '1', 4, 'f', 'a', 'k', 'e', 4, 't', 'e', 's', 't'));
  EXPECT_THAT(frames[2], ElementsAre(0x02, 1, 0, 1, 0, 0xFE, 0x03, 0, 0, 0xA0, 0x3B, 0, 0, 0, 0, 2, 'A', '1', 1, 'V'));
}

TEST_F(BoardTest, DescribeIsAnsweredByEverythingAndTheOthersByOneDescriptor) {
  EXPECT_EQ(command({0x81}).size(), 3U);
  for (const Bytes& payload : {Bytes{0x83}, Bytes{0x84, 1}, Bytes{0x84, 0}}) {
    const auto frames = command(payload);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0][0], 0x01);
  }
}

TEST_F(BoardTest, ScansHaveCounterTicksAndCodes) {
  const auto answer = start();
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(flags(answer[0]), 0x03 | kStreaming);
  EXPECT_EQ(hardware_.period, 2000);
  sample(45);
  const auto frames = polled();
  ASSERT_EQ(frames.size(), 2U) << "20 scans a frame; 5 wait for more";
  EXPECT_EQ(frames[0].size(), 11U + 20 * 4);
  EXPECT_EQ(u32_at(frames[0], 2), 0xFFFFFFF0U);
  EXPECT_EQ(u32_at(frames[0], 6), 0xFFFFF000U);
  EXPECT_EQ(frames[0][10], 20);
  EXPECT_EQ(i16_at(frames[0], 11 + 4 * 7), 7);
  EXPECT_EQ(i16_at(frames[0], 11 + 4 * 7 + 2), -7);
  EXPECT_EQ(u32_at(frames[1], 2), 4U) << "the counter wraps";
  EXPECT_EQ(u32_at(frames[1], 6), 0xFFFFF000U + 40'000U) << "so do the ticks";
}

TEST_F(BoardTest, StartWhileStreamingChangesNothing) {
  start(500);
  sample(3);
  const auto answer = start(100);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(u32_at(answer[0], 8), 4000U) << "the rate stays 500 Hz";
  sample(17);
  const auto frames = polled();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(u32_at(frames[0], 2), 0xFFFFFFF0U);
}

TEST_F(BoardTest, EveryStartIsANewRun) {
  board_.begin();
  start();
  sample(20);
  const uint8_t first = polled().at(0)[1];
  command({0x83});
  start();
  sample(20);
  EXPECT_EQ(polled().at(0)[1], static_cast<uint8_t>(first + 1));
  Board<FakeHardware> after_reset(hardware_);
  after_reset.begin();
  EXPECT_EQ(hardware_.cells.at(4), static_cast<uint8_t>(first + 2));
}

TEST_F(BoardTest, NoScanLeavesBeforeTheRunIsInTheEeprom) {
  hardware_.stored = false;
  start();
  sample(40);
  EXPECT_TRUE(polled().empty());
  hardware_.stored = true;
  EXPECT_EQ(polled().size(), 2U);
}

TEST_F(BoardTest, StopSendsTheTailThenLostThenTheDescriptor) {
  start();
  sample(23);
  hardware_.converting = true;
  auto frames = command({0x83});
  EXPECT_FALSE(hardware_.is_sampling);
  ASSERT_EQ(frames.size(), 1U) << "the last scan is still being converted";
  sample(1);
  hardware_.converting = false;
  frames = polled();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0][0], 0x03);
  EXPECT_EQ(frames[0][10], 4);
  const Bytes counter = u32_bytes(0xFFFFFFF0U + 24);
  EXPECT_THAT(frames[1], ElementsAre(0x04, frames[0][1], counter[0], counter[1], counter[2], counter[3], 4, 0, 0, 0, 0));
  EXPECT_EQ(frames[2][0], 0x01);
  EXPECT_EQ(flags(frames[2]), 0x03);
}

TEST_F(BoardTest, ACommandAfterStopWaitsForTheTail) {
  start();
  sample(1);
  hardware_.converting = true;
  command({0x83});
  EXPECT_TRUE(start(500).empty());
  hardware_.converting = false;
  const auto frames = polled();
  EXPECT_EQ(frames.at(1)[0], 0x04);
  EXPECT_EQ(flags(frames.back()), 0x03 | kStreaming);
  EXPECT_EQ(hardware_.period, 4000);
}

TEST_F(BoardTest, ALossIsReportedAfterTheScansBeforeIt) {
  start();
  sample(70);  // 64 places
  auto frames = polled();
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(frames[3][10], 4) << "the rest is not held back until it fills a frame";
  EXPECT_EQ(frames[4][0], 0x04);
  EXPECT_EQ(u32_at(frames[4], 2), 0xFFFFFFF0U + 70);
  EXPECT_EQ(frames[4][6], 1);
  EXPECT_EQ(u32_at(frames[4], 7), 6U);
  sample(20);
  frames = polled();
  EXPECT_EQ(u32_at(frames.at(0), 2), 0xFFFFFFF0U + 70);
  EXPECT_EQ(u32_at(frames.at(0), 6), 0xFFFFF000U + 70 * 2000U);
  EXPECT_EQ(i16_at(frames.at(0), 11), 70);
}

TEST_F(BoardTest, ALossAtTheEndIsReportedBeforeTheStop) {
  start();
  sample(66);
  const auto frames = command({0x83});
  ASSERT_GE(frames.size(), 3U);
  EXPECT_EQ(frames[frames.size() - 3][6], 1);
  EXPECT_EQ(frames[frames.size() - 2][6], 4);
}

TEST_F(BoardTest, ThePatternBeginsAfterTheDescriptorThatAnnouncesIt) {
  start();
  sample(20);
  const auto data = polled();
  EXPECT_EQ(i16_at(data.at(0), 11), 0);
  sample(19);
  const auto answer = command({0x84, 1});
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(flags(answer[0]), 0x03 | kPattern | kStreaming);
  sample(1);
  const auto frames = polled();
  const uint64_t counter = u32_at(frames.at(0), 2);
  EXPECT_EQ(i16_at(frames[0], 11 + 4 * 5), static_cast<int16_t>(((counter + 5) * 7) % 32768));
  EXPECT_EQ(i16_at(frames[0], 11 + 4 * 5 + 2), static_cast<int16_t>(((counter + 5) * 7 + 1000) % 32768));
  const auto stopped = command({0x83});
  EXPECT_EQ(flags(stopped.back()), 0x03) << "the pattern is off after STOP";
}

TEST_F(BoardTest, StopEndsThePatternOfAnIdleBoard) {
  EXPECT_EQ(flags(command({0x84, 1}).at(0)), 0x03 | kPattern);
  const auto answer = command({0x83});
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(flags(answer[0]), 0x03);
  EXPECT_EQ(flags(start().at(0)), 0x03 | kStreaming);
}

TEST_F(BoardTest, EachOfSeveralCommandsIsAnswered) {
  for (const Bytes& payload :
       {Bytes{0x81}, Bytes{0x82, 0, 0, 0, 0, 1, 0, 0, 0}, Bytes{0x84, 1}, Bytes{0x77}, Bytes{0x77}, Bytes{0x84, 0}}) {
    for (const uint8_t byte : encoded(payload)) board_.from_host.add(byte);
  }
  board_.from_host.publish();
  std::vector<int> seen;  // types; of a descriptor, 0x100 and its flags
  for (const Bytes& frame : polled()) seen.push_back(frame[0] == 0x01 ? 0x100 + flags(frame) : frame[0]);
  EXPECT_THAT(seen, ElementsAre(0x103, 0x02, 0x02, 0x10B, 0x10F, 0x05, 0x05, 0x10B));
}

TEST_F(BoardTest, ARegularDescriptionDoesNotRepeatTheOneThatIsBeingSent) {
  board_.begin();
  board_.poll();
  board_.describe_again();
  const auto frames = polled();
  EXPECT_EQ(frames.size(), 3U);
}

TEST_F(BoardTest, ADescriptionWaitsUntilTheQueueIsBelowHalf) {
  start();
  hardware_.stored = false;  // scans stay in the queue
  sample(32);
  EXPECT_TRUE(command({0x81}).empty());
  hardware_.stored = true;
  const auto frames = polled();
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0][0], 0x03);
}

TEST_F(BoardTest, TheRateIsTheOneThatTheBoardRuns) {
  const auto rates = std::to_array<std::pair<uint32_t, uint16_t>>({{1000, 2000}, {300, 6667}, {5000, 2000}, {1, 0xFFFF}, {31, 64516}});
  for (const auto& [wanted, period] : rates) {
    const auto answer = start(wanted);
    EXPECT_EQ(hardware_.period, period);
    EXPECT_EQ(u32_at(answer.at(0), 8), period);
    command({0x83});
  }
}

TEST_F(BoardTest, AFrameNeverWaitsForMoreThanFortyMilliseconds) {
  start(100);
  sample(5);
  const auto frames = polled();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0][10], 5);
}

TEST_F(BoardTest, AWrongCommandIsLoggedAndChangesNothing) {
  for (const Bytes& payload : {Bytes{0x82, 1}, Bytes{0x84}, Bytes{0x83, 0}, Bytes{0x77}}) {
    const auto frames = command(payload);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0][0], 0x05);
  }
  const auto frames = start(100, 0);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(flags(frames[0]), 0x03);
  EXPECT_FALSE(hardware_.is_sampling);
}

TEST_F(BoardTest, TheLedShowsIdleRunAndLoss) {
  const auto changes = [this](uint16_t from) {
    int count = 0;
    for (uint16_t beat = from; beat < from + 60; ++beat) {
      count += board_.is_led_on(beat) != board_.is_led_on(static_cast<uint16_t>(beat + 1)) ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(changes(0), 2);
  start();
  EXPECT_EQ(changes(100), 0);
  EXPECT_TRUE(board_.is_led_on(160));
  sample(70);
  polled();
  EXPECT_GE(changes(200), 18);
  EXPECT_EQ(changes(300), 0) << "steady again 2 s after the loss";
}

TEST_F(BoardTest, TheLongestTextsFit) {
  hardware_.serial_text = std::string(40, 'x');
  const auto frames = command({0x81});
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0][17], 32);
}

TEST_F(BoardTest, ADescriptionDuringARunLosesNothing) {
  start();
  for (int round = 0; round < 40; ++round) {
    sample(20);
    const auto frames = command({0x81});
    for (const Bytes& frame : frames) ASSERT_NE(frame[0], 0x04);
    ASSERT_EQ(frames.size(), 4U);
    EXPECT_NE(frames[3][0], 0x03) << "scans must not wait for the whole description";
  }
}

TEST(InterruptedBoard, ScansAndALossThatHappenDuringOneLookKeepTheirOrder) {
  InterruptedHardware hardware;
  Board<InterruptedHardware> board(hardware);
  for (const uint8_t byte : encoded({0x82, 0, 0, 0, 0, 1, 0, 0, 0})) board.from_host.add(byte);
  board.from_host.publish();
  for (int i = 0; i < 5; ++i) board.poll();
  take_frames(board.to_host);
  Interrupted::interrupt = [&board] {
    Interrupted::interrupt = nullptr;
    while (board.scans.slot() != nullptr) board.scans.commit();
    board.scans.lose(6, Reason::kBufferFull);
  };
  std::vector<Bytes> frames;
  for (int i = 0; i < 20; ++i) {
    board.poll();
    for (Bytes& frame : take_frames(board.to_host)) frames.push_back(std::move(frame));
  }
  ASSERT_EQ(frames.size(), 5U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(u32_at(frames[i], 2), static_cast<uint32_t>(0xFFFFFFF0U + 20 * i));
  EXPECT_EQ(frames[4][0], 0x04);
  EXPECT_EQ(u32_at(frames[4], 2), 0xFFFFFFF0U + 70);
}

TEST(Plan, FramesTakeLessThanTheLine) {
  for (uint8_t channels = 1; channels <= 8; ++channels) {
    const Limits limits{channels, 2'000'000, 2000, 0xFFFF, 11'520};
    const uint16_t period = shortest_period(limits);
    const uint8_t scans = scans_per_frame(limits, period);
    const double bytes_per_second = FrameWriter::size_on_wire(scans_payload(channels, scans)) * 2e6 / period / scans;
    EXPECT_LT(bytes_per_second, 11'520 * 0.93) << int{channels} << " channels";
    EXPECT_LE(scans_payload(channels, scans), kLargestScansPayload);
    if (channels <= 4) {
      EXPECT_EQ(period, 2000) << "4 channels run at 1000 Hz";
    }
  }
}

}  // namespace
}  // namespace firmware::test
