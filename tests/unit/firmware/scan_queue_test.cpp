// SPDX-License-Identifier: Apache-2.0
#include "firmware/scan_queue.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "firmware/run_number.h"
#include "unit/firmware/fake_hardware.h"

namespace firmware::test {
namespace {

using Queue = ScanQueue<1, 8, FakeHardware::Guard>;

bool push(Queue& queue, int16_t code) {
  int16_t* const slot = queue.slot();
  if (slot == nullptr) {
    queue.lose(1, Reason::kBufferFull);
    return false;
  }
  slot[0] = code;
  queue.commit();
  return true;
}

TEST(ScanQueue, HoldsAsManyScansAsItHasPlaces) {
  Queue queue;
  for (int16_t i = 0; i < 8; ++i) EXPECT_TRUE(push(queue, i));
  EXPECT_EQ(queue.size(), 8);
  EXPECT_FALSE(queue.has_loss());
  EXPECT_FALSE(push(queue, 8));
  EXPECT_TRUE(queue.has_loss());
}

TEST(ScanQueue, AcceptsNothingBetweenALossAndItsReport) {
  Queue queue;
  for (int16_t i = 0; i < 9; ++i) push(queue, i);
  queue.pop();
  EXPECT_FALSE(push(queue, 9)) << "a scan after the loss would stand before it";
  for (int16_t i = 1; i < 8; ++i) {
    EXPECT_EQ(queue.front()[0], i);
    queue.pop();
  }
  EXPECT_EQ(queue.take_loss().scans, 2U);
  EXPECT_TRUE(push(queue, 10));
  EXPECT_EQ(queue.front()[0], 10);
}

TEST(ScanQueue, TheFirstReasonIsReported) {
  Queue queue;
  push(queue, 0);
  queue.lose(3, Reason::kLate);
  queue.lose(1, Reason::kBufferFull);
  queue.pop();
  const Queue::Loss loss = queue.take_loss();
  EXPECT_EQ(loss.reason, Reason::kLate);
  EXPECT_EQ(loss.scans, 4U);
}

TEST(ScanQueue, EveryScanIsDeliveredOrCounted) {
  Queue queue;
  std::mt19937 random(3);
  int16_t pushed = 0;
  int16_t expected = 0;  // of the scan that leaves next
  for (int round = 0; round < 20'000; ++round) {
    for (auto n = random() % 12; n > 0; --n) push(queue, pushed++);
    for (auto n = random() % 12; n > 0; --n) {
      if (queue.size() != 0) {
        ASSERT_EQ(queue.front()[0], expected++);
        queue.pop();
      } else if (queue.has_loss()) {
        expected = static_cast<int16_t>(expected + static_cast<int16_t>(queue.take_loss().scans));
      }
    }
    if (pushed > 30'000) pushed = expected = 0, queue = Queue();
  }
}

class InterruptedQueue : public ::testing::Test {
 protected:
  using Queue = ScanQueue<1, 8, Interrupted>;
  void TearDown() override { Interrupted::interrupt = nullptr; }

  void sample(int scans) {
    for (; scans > 0; --scans, ++code_) {
      int16_t* const slot = queue_.slot();
      if (slot == nullptr) {
        queue_.lose(1, Reason::kBufferFull);
      } else {
        slot[0] = code_;
        queue_.commit();
      }
    }
  }

  Queue queue_;
  int16_t code_ = 0;
};

TEST_F(InterruptedQueue, ALossIsReadWithInterruptsOff) {
  Interrupted::guards = 0;
  EXPECT_FALSE(queue_.has_loss());
  EXPECT_EQ(Interrupted::guards, 1) << "the number of lost scans has four bytes: an interrupt between them changes it";
  sample(9);
  while (queue_.size() != 0) queue_.pop();
  Interrupted::guards = 0;
  EXPECT_EQ(queue_.take_loss().scans, 1U);
  EXPECT_EQ(Interrupted::guards, 1);
}

TEST_F(InterruptedQueue, EveryScanIsDeliveredOrCountedWhereverTheInterruptHappens) {
  std::mt19937 random(5);
  Interrupted::interrupt = [&] { sample(static_cast<int>(random() % 12)); };
  int16_t expected = 0;
  for (int step = 0; step < 5'000; ++step) {
    Interrupted::happen();
    const bool has_loss = queue_.has_loss();  // in this order, as in Board
    const uint8_t ready = queue_.size();
    if (ready != 0) {
      ASSERT_EQ(queue_.front()[0], expected++);
      queue_.pop();
    } else if (has_loss) {
      expected = static_cast<int16_t>(expected + static_cast<int16_t>(queue_.take_loss().scans));
    }
    if (expected > 20'000) break;
  }
  EXPECT_GT(expected, 1000);
}

TEST(RunNumber, DiffersAfterEveryReset) {
  std::vector<uint8_t> cells(RunNumber::kCells, 0xFF);
  std::vector<int> writes(RunNumber::kCells, 0);
  uint8_t before = 0xFF;
  for (int reset = 0; reset < 6400; ++reset) {
    RunNumber run;
    run.load([&](uint8_t cell) { return cells[cell]; });
    run.advance();
    EXPECT_EQ(run.value(), static_cast<uint8_t>(before + 1));
    before = run.value();
    cells[run.cell()] = run.value();
    ++writes[run.cell()];
  }
  for (const int count : writes) EXPECT_EQ(count, 100) << "one cell wears more than the others";
}

TEST(RunNumber, GoesOnAfterAWriteThatAResetCutOff) {
  std::vector<uint8_t> cells(RunNumber::kCells, 0xFF);
  RunNumber run;
  for (int i = 0; i < 100; ++i) {
    run.load([&](uint8_t cell) { return cells[cell]; });
    run.advance();
    cells[run.cell()] = run.value();
  }
  const uint8_t newest = run.value();
  cells[(run.cell() + 1) % RunNumber::kCells] = 0xA5;  // neither the old value nor the new one
  run.load([&](uint8_t cell) { return cells[cell]; });
  run.advance();
  EXPECT_EQ(run.value(), static_cast<uint8_t>(newest + 1));
}

}  // namespace
}  // namespace firmware::test
