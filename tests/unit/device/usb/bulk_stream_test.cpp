// SPDX-License-Identifier: Apache-2.0
#include "device/usb/bulk_stream.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "core/doorbell.h"
#include "support/allocation_counter.h"

namespace dts::device::usb {
namespace {

constexpr StreamShape kShape{.endpoint = 0x81, .transfer_bytes = 64, .transfer_count = 4, .buffer_chunks = 16};

/// What all ports of this file answer to what a stream never asks.
class StreamOnlyPort : public UsbPort {
 public:
  const UsbUnit& unit() const noexcept override { return unit_; }
  core::Result<std::size_t> max_packet_bytes(std::uint8_t) const override { return 64; }
  bool is_high_speed() const noexcept override { return false; }
  UsbResult control_in(const ControlRequest&, std::span<std::uint8_t>, int) override { return 0; }
  UsbResult control_out(const ControlRequest&, std::span<const std::uint8_t>, int) override { return 0; }
  UsbResult bulk_in(std::uint8_t, std::span<std::uint8_t>, int) override { return 0; }
  UsbResult bulk_out(std::uint8_t, std::span<const std::uint8_t>, int) override { return 0; }
  UsbResult clear_halt(std::uint8_t) override { return 0; }

 private:
  UsbUnit unit_;
};

/// Does what the test says, in its thread.
class ScriptedPort final : public StreamOnlyPort {
 public:
  explicit ScriptedPort(core::VirtualClock& clock) : clock_(clock) {}

  std::uint64_t fail_submit = std::numeric_limits<std::uint64_t>::max();  ///< From this one on.
  UsbStatus submit_status = UsbStatus::NoDevice;
  bool answers_cancel = true;
  bool fails_prepare = false;
  TransferListener* listener = nullptr;
  int releases = 0;
  std::set<std::size_t> flying;

  void finish(std::size_t index, UsbStatus status, std::span<const std::uint8_t> bytes) {
    ASSERT_EQ(flying.erase(index), 1U);
    cancelled_.erase(index);
    listener->on_transfer(index, status, bytes, clock_.now_ns());
  }

  core::Status prepare_transfers(std::uint8_t, std::size_t count, std::size_t, TransferListener& wanted) override {
    if (fails_prepare) return core::fail(core::ErrorCode::NotFound, "no such endpoint");
    count_ = count;
    listener = &wanted;
    return {};
  }
  UsbStatus submit(std::size_t index) noexcept override {
    if (submits_++ >= fail_submit) return submit_status;
    EXPECT_LT(index, count_);
    EXPECT_TRUE(flying.insert(index).second) << "submitted while in flight";
    return UsbStatus::Completed;
  }
  void cancel(std::size_t index) noexcept override {
    if (flying.contains(index)) cancelled_.insert(index);
  }
  void release_transfers() noexcept override {
    EXPECT_TRUE(flying.empty());
    ++releases;
  }
  void wait(std::int64_t deadline_ns) noexcept override {
    clock_.sleep_until_ns(deadline_ns);
    if (!answers_cancel) return;
    for (const std::size_t index : std::exchange(cancelled_, {})) finish(index, UsbStatus::Cancelled, {});
  }

 private:
  core::VirtualClock& clock_;
  std::size_t count_ = 0;
  std::uint64_t submits_ = 0;
  std::set<std::size_t> cancelled_;
};

class BulkStreamTest : public testing::Test {
 protected:
  std::unique_ptr<BulkStream> create(const StreamShape& shape = kShape) {
    auto stream = BulkStream::create(port_, shape, clock_);
    EXPECT_TRUE(stream.has_value());
    return std::move(*stream);
  }

  core::VirtualClock clock_{core::kNanosecondsPerMillisecond};
  ScriptedPort port_{clock_};
};

TEST_F(BulkStreamTest, Completed_ChunkWithStampAndInFlightAgainUntilStopped) {
  const auto stream = create();
  ASSERT_EQ(stream->start(), UsbStatus::Completed);
  EXPECT_EQ(port_.flying.size(), 4U);
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  clock_.advance_ns(77);

  port_.finish(2, UsbStatus::Completed, bytes);

  const Chunk* const chunk = stream->front();
  ASSERT_NE(chunk, nullptr);
  EXPECT_EQ(chunk->status, UsbStatus::Completed);
  EXPECT_EQ(chunk->stamp_ns, core::kNanosecondsPerMillisecond + 77);
  EXPECT_EQ(chunk->length, 3U);
  EXPECT_EQ(chunk->bytes[2], 3);
  stream->release();
  EXPECT_EQ(stream->front(), nullptr);
  EXPECT_EQ(stream->in_flight(), 4);

  port_.finish(1, UsbStatus::Completed, {});
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(stream->stop(100));
    EXPECT_EQ(stream->front(), nullptr) << "what was not read is gone";
    EXPECT_EQ(port_.releases, 1);
  }
}

TEST_F(BulkStreamTest, EveryStatusAtEveryTransfer_ToldOnceAndNotSubmittedAgain) {
  for (const UsbStatus status :
       {UsbStatus::Stall, UsbStatus::NoDevice, UsbStatus::Overflow, UsbStatus::TimedOut, UsbStatus::Cancelled, UsbStatus::Failed}) {
    for (std::size_t index = 0; index < kShape.transfer_count; ++index) {
      const auto stream = create();
      ASSERT_EQ(stream->start(), UsbStatus::Completed);
      const std::array<std::uint8_t, 2> bytes{9, 8};

      port_.finish(index, status, bytes);

      const Chunk* const chunk = stream->front();
      ASSERT_NE(chunk, nullptr);
      EXPECT_EQ(chunk->status, status);
      EXPECT_EQ(chunk->length, 2U);
      EXPECT_EQ(stream->in_flight(), 3);
      EXPECT_FALSE(port_.flying.contains(index));
      EXPECT_TRUE(stream->stop(100));
      EXPECT_EQ(stream->in_flight(), 0);
    }
  }
}

TEST_F(BulkStreamTest, ResubmitFails_ChunkSaysSo) {
  const auto stream = create();
  ASSERT_EQ(stream->start(), UsbStatus::Completed);
  port_.fail_submit = 0;

  port_.finish(0, UsbStatus::Completed, {});

  ASSERT_NE(stream->front(), nullptr);
  stream->release();
  ASSERT_NE(stream->front(), nullptr);
  EXPECT_EQ(stream->front()->status, UsbStatus::NoDevice);
  EXPECT_EQ(stream->in_flight(), 3);
  EXPECT_TRUE(stream->stop(100));
}

TEST_F(BulkStreamTest, SubmitFailsAtEveryPointOfTheStart_TheOthersAreEnded) {
  for (std::uint64_t accepted = 0; accepted < kShape.transfer_count; ++accepted) {
    ScriptedPort port(clock_);
    port.fail_submit = accepted;
    port.submit_status = UsbStatus::Failed;
    auto stream = std::move(*BulkStream::create(port, kShape, clock_));

    EXPECT_EQ(stream->start(), UsbStatus::Failed);
    EXPECT_EQ(stream->in_flight(), static_cast<int>(accepted));
    EXPECT_TRUE(stream->stop(100));
    EXPECT_TRUE(port.flying.empty());
    EXPECT_EQ(port.releases, 1);
  }
}

TEST_F(BulkStreamTest, CancelReturnsLate_FalseInTimeAndNothingFreedUntilAllAreBack) {
  const auto stream = create();
  ASSERT_EQ(stream->start(), UsbStatus::Completed);
  port_.answers_cancel = false;
  const std::int64_t before_ns = clock_.now_ns();

  EXPECT_FALSE(stream->stop(100));

  EXPECT_EQ(clock_.now_ns(), before_ns + 100 * core::kNanosecondsPerMillisecond);
  EXPECT_EQ(port_.releases, 0);
  EXPECT_EQ(stream->in_flight(), 4);
  port_.finish(0, UsbStatus::Completed, {});
  EXPECT_EQ(stream->in_flight(), 3) << "not submitted again";
  EXPECT_FALSE(port_.flying.contains(0));
  port_.answers_cancel = true;  // they come late after all
  EXPECT_TRUE(stream->stop(100));
}

TEST_F(BulkStreamTest, ReaderAway_NewChunksDroppedAndCounted) {
  const auto stream = create();
  ASSERT_EQ(stream->start(), UsbStatus::Completed);
  for (std::uint8_t i = 0; i < 20; ++i) port_.finish(i % 4U, UsbStatus::Completed, std::array<std::uint8_t, 1>{i});

  EXPECT_EQ(stream->dropped(), 4U);
  for (std::uint8_t i = 0; i < 16; ++i, stream->release()) EXPECT_EQ(stream->front()->bytes[0], i);
  EXPECT_EQ(stream->front(), nullptr);
  EXPECT_EQ(stream->in_flight(), 4);
  EXPECT_TRUE(stream->stop(100));
}

TEST_F(BulkStreamTest, Transfer_AllocatesNothing) {
  const auto stream = create();
  ASSERT_EQ(stream->start(), UsbStatus::Completed);
  const std::array<std::uint8_t, 64> bytes{};
  port_.fail_submit = 0;  // the script's own list allocates when it takes one
  port_.flying.erase(0);

  const std::uint64_t before = dts::test::heap_calls_of_this_thread();
  port_.listener->on_transfer(0, UsbStatus::Completed, bytes, 1);
  EXPECT_EQ(dts::test::heap_calls_of_this_thread(), before);
  EXPECT_TRUE(stream->stop(100));
}

TEST_F(BulkStreamTest, ImpossibleShapes_Refused) {
  for (const StreamShape& shape :
       {StreamShape{0x81, 0, 4, 16}, StreamShape{0x81, 64, 0, 16}, StreamShape{0x81, 64, 4, 0}, StreamShape{0x81, 64, 100'000, 16},
        StreamShape{0x81, 1U << 20U, 4, 16}, StreamShape{0x81, 64, 4, 1U << 30U}}) {
    const auto stream = BulkStream::create(port_, shape, clock_);
    ASSERT_FALSE(stream.has_value());
    EXPECT_EQ(stream.error().code, core::ErrorCode::LimitExceeded);
  }
  port_.fails_prepare = true;
  EXPECT_EQ(BulkStream::create(port_, kShape, clock_).error().code, core::ErrorCode::NotFound);
}

/// Finishes transfers in a thread of its own, as fast as it can: the real division of work.
class ThreadedPort final : public StreamOnlyPort {
 public:
  static constexpr std::uint32_t kMostCompletions = 4000;  ///< Then only cancelled ones end.

  core::Status prepare_transfers(std::uint8_t, std::size_t count, std::size_t, TransferListener& listener) override {
    listener_ = &listener;
    states_ = std::vector<std::atomic<State>>(count);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    return {};
  }
  UsbStatus submit(std::size_t index) noexcept override {
    states_[index].store(State::Flying, std::memory_order_release);  // pairs with run
    return UsbStatus::Completed;
  }
  void cancel(std::size_t index) noexcept override {
    State flying = State::Flying;
    states_[index].compare_exchange_strong(flying, State::Cancelled, std::memory_order_acq_rel);  // pairs with run
  }
  void release_transfers() noexcept override {
    thread_ = {};  // stops and joins
    for (auto& state : states_) EXPECT_EQ(state.load(), State::Idle);
  }
  void wait(std::int64_t) noexcept override { bell_.wait(1); }

 private:
  enum class State : int { Idle, Flying, Cancelled };

  void run(const std::stop_token& stop) {
    std::uint32_t count = 0;
    while (!stop.stop_requested()) {
      for (std::size_t i = 0; i < states_.size(); ++i) {
        if (count == kMostCompletions && states_[i].load(std::memory_order_relaxed) == State::Flying) continue;
        const State state = states_[i].exchange(State::Idle, std::memory_order_acq_rel);  // pairs with submit and cancel
        if (state == State::Idle) continue;
        std::array<std::uint8_t, 64> bytes{};
        std::memcpy(bytes.data(), &count, sizeof count);
        if (state == State::Flying) ++count;
        listener_->on_transfer(i, state == State::Flying ? UsbStatus::Completed : UsbStatus::Cancelled, bytes, 1);
        bell_.ring();
      }
    }
  }

  TransferListener* listener_ = nullptr;
  std::vector<std::atomic<State>> states_;
  core::Doorbell bell_;
  std::jthread thread_;
};

TEST(BulkStreamThreads, StoppedWhileTransfersFinish_AllBackEveryChunkWholeAndInOrder) {
  for (std::uint32_t round = 0; round < 30; ++round) {
    core::SystemClock clock;
    ThreadedPort port;
    auto stream = std::move(*BulkStream::create(port, {0x81, 64, 8, ThreadedPort::kMostCompletions + 8}, clock));
    ASSERT_EQ(stream->start(), UsbStatus::Completed);
    for (std::uint32_t next = 0; next < 100 * round;) {
      const Chunk* const chunk = stream->front();
      if (chunk == nullptr) continue;
      std::uint32_t count = 0;
      std::memcpy(&count, chunk->bytes.data(), sizeof count);
      ASSERT_EQ(count, next);
      ++next;
      stream->release();
    }
    EXPECT_TRUE(stream->stop(60'000));
    EXPECT_EQ(stream->in_flight(), 0);
    EXPECT_EQ(stream->dropped(), 0U);
  }
}

}  // namespace
}  // namespace dts::device::usb
