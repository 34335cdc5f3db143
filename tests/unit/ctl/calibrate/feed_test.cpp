// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/libdts/fake_daemon.h"

namespace dts::ctl {
namespace {

using client::ErrorCode;
using testing::block;
using testing::FakePublisher;
using testing::floor_status;

/// A feed of two of the three channels of floor/cop, subscribed to a daemon that the test plays.
class LiveFeedTest : public ::testing::Test {
 protected:
  LiveFeedTest() : daemon_(data_) {
    feed_ = LiveFeed::open({.endpoints = {.data = data_}}, "floor", "cop", {"load_n", "ml_mm"}).value();
    EXPECT_TRUE(daemon_.wait_for_subscription("floor/cop", [this] { static_cast<void>(feed_->next()); }));
    daemon_.send("dtsd/status", floor_status());
  }
  /// The next block; fails the test when none comes.
  FeedBlock next() {
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    while (std::chrono::steady_clock::now() < deadline) {
      auto block = feed_->next();
      if (!block) {
        ADD_FAILURE() << block.error().what;
        return {};
      }
      if (*block) return **block;
    }
    ADD_FAILURE() << "nothing came";
    return {};
  }
  void send(std::uint32_t segment, std::uint64_t first_scan, std::uint64_t sequence) {
    daemon_.send("floor/cop", block(segment, first_scan, 2, sequence));
  }

  testing::TemporaryDirectory directory_;
  std::string data_ = directory_.endpoint("data.sock");
  FakePublisher daemon_;
  std::optional<LiveFeed> feed_;
};

TEST_F(LiveFeedTest, Block_HasTheChannelsAskedForInTheirOrder) {
  send(1, 10, 1);

  const FeedBlock got = next();

  ASSERT_EQ(got.columns.size(), 2U);
  EXPECT_NEAR(got.columns[0][1], 11.2, 1e-5);  // load_n is channel 2, scan 11
  EXPECT_NEAR(got.columns[1][0], 10.0, 1e-5);
  EXPECT_FALSE(got.follows_loss) << "what came before the first block was never wanted";
}

TEST_F(LiveFeedTest, ScansMissingOnTheWay_Told) {
  send(1, 0, 1);
  send(1, 6, 3);

  EXPECT_FALSE(next().follows_loss);
  EXPECT_TRUE(next().follows_loss);
}

TEST_F(LiveFeedTest, NewSegmentOrGapEvent_IsALoss) {
  send(1, 0, 1);
  send(2, 0, 2);
  v1::Event gap = testing::marker("");
  gap.mutable_gap()->set_missing_scans(3);
  daemon_.send("floor/gap", gap);
  send(2, 2, 3);
  send(2, 4, 4);

  EXPECT_FALSE(next().follows_loss);
  EXPECT_TRUE(next().follows_loss);
  EXPECT_TRUE(next().follows_loss);
  EXPECT_FALSE(next().follows_loss);
}

TEST_F(LiveFeedTest, RestartOfTheDaemon_Fails) {
  send(1, 0, 1);
  EXPECT_FALSE(next().follows_loss);

  daemon_.send("dtsd/status", floor_status(8));
  daemon_.send("floor/cop", block(1, 0, 2, 1, 3, 8));
  client::Result<std::optional<FeedBlock>> got = std::nullopt;
  const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
  while (got && std::chrono::steady_clock::now() < deadline) got = feed_->next();

  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().code, ErrorCode::WrongState);
  EXPECT_THAT(got.error().hint, ::testing::HasSubstr("--resume"));
}

TEST_F(LiveFeedTest, RestartWhileNobodyReads_IsNotThrownAway) {
  send(1, 0, 1);
  EXPECT_FALSE(next().follows_loss);

  daemon_.send("dtsd/status", floor_status(8));
  daemon_.send("floor/cop", block(1, 0, 2, 1, 3, 8));
  client::Result<void> discarded;
  const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
  while (discarded && std::chrono::steady_clock::now() < deadline) discarded = feed_->discard();

  ASSERT_FALSE(discarded);
  EXPECT_EQ(discarded.error().code, ErrorCode::WrongState);
}

TEST(LiveFeed, NobodyThere_Unreachable) {
  const testing::TemporaryDirectory directory;

  EXPECT_EQ(LiveFeed::open({.endpoints = {.data = directory.endpoint("data.sock")}}, "floor", "cop", {"ml_mm"}).error().code,
            ErrorCode::Unreachable);
}

}  // namespace
}  // namespace dts::ctl
