// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/tab_queue.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "dts/v1/gateway.pb.h"

namespace dts::gateway {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;

const std::string kBlock(100, 'b');
const TabQueue::Time kStart{std::chrono::hours(1)};

CarriedPointer block(const std::string& topic, std::size_t bytes = 100, std::uint64_t scans = 4) {
  return std::make_shared<Carried>(
      Carried{.topic = topic, .kind = Carried::Kind::Block, .bytes = std::string(bytes, 'b'), .scans = scans, .is_retained = false});
}

CarriedPointer event(const std::string& topic, const std::string& bytes = "e") {
  return std::make_shared<Carried>(Carried{.topic = topic, .kind = Carried::Kind::Event, .bytes = bytes, .scans = 0, .is_retained = false});
}

CarriedPointer status(const std::string& bytes) {
  return std::make_shared<Carried>(
      Carried{.topic = "dtsd/status", .kind = Carried::Kind::Status, .bytes = bytes, .scans = 0, .is_retained = true});
}

v1::Frame frame_of(TabQueue& queue, TabQueue::Time now) {
  v1::FromGateway message;
  EXPECT_TRUE(message.ParseFromString(queue.take_frame(now)));
  return message.frame();
}

/// "topic message" of each.
std::vector<std::string> messages_of(const v1::Frame& frame) {
  std::vector<std::string> messages;
  for (const v1::Carried& carried : frame.messages()) messages.push_back(carried.topic() + " " + carried.message());
  return messages;
}

TabQueue subscribed(const std::vector<std::string>& prefixes) {
  TabQueue queue;
  EXPECT_TRUE(queue.subscribe(prefixes, 0.0));
  return queue;
}

TEST(TabQueue, BeforeASubscriptionOnlyTheStatusIsWanted) {
  const TabQueue queue;

  EXPECT_TRUE(queue.wants("dtsd/status"));
  EXPECT_FALSE(queue.wants("floor/cop"));
}

TEST(TabQueue, WhatComesTogetherLeavesTogetherAndInOrder) {
  TabQueue queue = subscribed({"floor/"});

  queue.push(block("floor/raw"), kStart);
  queue.push(block("chair/raw"), kStart);
  queue.push(event("floor/marker"), kStart + milliseconds(1));
  queue.push(block("floor/cop"), kStart + milliseconds(1));

  EXPECT_EQ(queue.due(), kStart + TabQueue::kGathering);
  EXPECT_THAT(messages_of(frame_of(queue, kStart + milliseconds(2))),
              ElementsAre("floor/raw " + kBlock, "floor/marker e", "floor/cop " + kBlock));
  EXPECT_EQ(queue.due(), std::nullopt);
}

TEST(TabQueue, FramesKeepTheRateThatWasAskedFor) {
  TabQueue queue;
  ASSERT_TRUE(queue.subscribe({""}, 10.0));
  queue.push(block("floor/cop"), kStart);
  std::ignore = queue.take_frame(kStart + milliseconds(2));

  queue.push(block("floor/cop"), kStart + milliseconds(5));

  EXPECT_EQ(queue.due(), kStart + milliseconds(102));
}

TEST(TabQueue, ATabThatDoesNotPaintGetsTwoFramesAndTheThirdAfterItPainted) {
  TabQueue queue = subscribed({""});
  for (int frame = 0; frame < 2; ++frame) {
    queue.push(block("floor/cop"), kStart);
    ASSERT_TRUE(queue.due());
    std::ignore = queue.take_frame(kStart);
  }
  queue.push(block("floor/cop"), kStart);
  EXPECT_EQ(queue.due(), std::nullopt);

  EXPECT_TRUE(queue.painted(1));

  EXPECT_TRUE(queue.due());
}

TEST(TabQueue, OnlyAFrameUnderWayCanBePainted) {
  TabQueue queue = subscribed({""});
  EXPECT_FALSE(queue.painted(1));
  queue.push(block("floor/cop"), kStart);
  std::ignore = queue.take_frame(kStart);

  EXPECT_FALSE(queue.painted(0));
  EXPECT_FALSE(queue.painted(2));
  EXPECT_TRUE(queue.painted(1));
  EXPECT_FALSE(queue.painted(1));
}

TEST(TabQueue, TheOldestBlocksGoFirstAndAreCountedEventsStay) {
  TabQueue queue = subscribed({""});
  queue.push(event("floor/marker"), kStart);
  const std::size_t fits = TabQueue::kMostBytes / 1024;

  for (std::size_t index = 0; index < fits + 10; ++index) queue.push(block("floor/raw", 1024, 7), kStart);

  EXPECT_LE(queue.bytes(), TabQueue::kMostBytes);
  const v1::Frame frame = frame_of(queue, kStart);
  EXPECT_EQ(frame.messages(0).topic(), "floor/marker");
  const auto arrived = static_cast<std::uint64_t>(frame.messages_size() - 1);
  EXPECT_EQ(frame.dropped_blocks_total(), fits + 10 - arrived);
  EXPECT_EQ(frame.dropped_scans_total(), 7 * frame.dropped_blocks_total());
  EXPECT_EQ(frame.dropped_events_total(), 0U);
}

TEST(TabQueue, OfTooManyEventsTheOldestGoAndAreCounted) {
  TabQueue queue = subscribed({""});

  for (std::size_t index = 0; index < TabQueue::kMostEvents + 3; ++index) queue.push(event("floor/marker", std::to_string(index)), kStart);

  const v1::Frame frame = frame_of(queue, kStart);
  EXPECT_EQ(static_cast<std::size_t>(frame.messages_size()), TabQueue::kMostEvents);
  EXPECT_EQ(frame.messages(0).message(), "3");
  EXPECT_EQ(frame.dropped_events_total(), 3U);
}

TEST(TabQueue, AMessageLargerThanTheLimitStillArrivesAlone) {
  TabQueue queue = subscribed({""});

  queue.push(block("floor/raw", 100), kStart);
  queue.push(block("floor/raw", TabQueue::kMostBytes + 1), kStart);

  EXPECT_EQ(frame_of(queue, kStart).messages_size(), 1);
  EXPECT_EQ(queue.bytes(), 0U);
}

TEST(TabQueue, OnlyTheNewestStatusWaits) {
  TabQueue queue;

  queue.push(status("old"), kStart);
  queue.push(status("new"), kStart);

  EXPECT_THAT(messages_of(frame_of(queue, kStart)), ElementsAre("dtsd/status new"));
}

TEST(TabQueue, ANewSubscriptionForgetsWhatIsNoLongerWanted) {
  TabQueue queue = subscribed({"floor/", "chair/"});
  queue.push(block("floor/cop"), kStart);
  queue.push(block("chair/transient"), kStart);
  queue.push(event("floor/marker"), kStart);

  ASSERT_TRUE(queue.subscribe({"chair/"}, 0.0));

  EXPECT_EQ(queue.bytes(), 100U);
  const v1::Frame frame = frame_of(queue, kStart);
  EXPECT_THAT(messages_of(frame), ElementsAre("chair/transient " + kBlock));
  EXPECT_EQ(frame.dropped_blocks_total(), 0U);
}

TEST(TabQueue, ImpossibleSubscriptionsAreRefusedAndChangeNothing) {
  TabQueue queue = subscribed({"floor/"});
  const auto prefixes = [](std::size_t count, std::size_t length) { return std::vector(count, std::string(length, 'a')); };

  EXPECT_FALSE(queue.subscribe(prefixes(TabQueue::kMostPrefixes + 1, 1), 0.0));
  EXPECT_FALSE(queue.subscribe(prefixes(1, TabQueue::kLongestPrefix + 1), 0.0));
  for (const double rate_hz : {-1.0, 0.999, 120.001, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(queue.subscribe({"x"}, rate_hz)) << rate_hz;
  }
  EXPECT_EQ(queue.prefixes(), std::vector<std::string>{"floor/"});

  EXPECT_TRUE(queue.subscribe(prefixes(TabQueue::kMostPrefixes, TabQueue::kLongestPrefix), 0.0));
  for (const double rate_hz : {1.0, 120.0}) EXPECT_TRUE(queue.subscribe({"x"}, rate_hz)) << rate_hz;
}

}  // namespace
}  // namespace dts::gateway
