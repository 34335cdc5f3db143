// SPDX-License-Identifier: Apache-2.0
#include "unit/libdts/inbox_fixture.h"

#include <limits>

namespace dts::client {
namespace {

using testing::block;
using testing::floor_status;
using testing::marker;

using InboxLatestTest = InboxTest;

v1::StreamBlock at(std::uint64_t first_scan, std::int64_t host_time_ns) {
  v1::StreamBlock message = block(1, first_scan, 1, first_scan + 1);
  message.set_host_time_ns(host_time_ns);
  return message;
}

TEST_F(InboxLatestTest, AfterAStall_NewestBlockOfEachStreamAndExactSkippedScans) {
  Inbox latest = learnt(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  EXPECT_EQ(told(latest), Lines{"floor/cop 1:0+3"});
  for (std::uint64_t number = 1; number <= 400; ++number) {
    give(latest, "floor/cop", block(1, 3 * number, 3, number + 1));
    give(latest, "floor/raw", block(1, 2 * number, 2, number, 1));
    give(latest, "floor/marker", marker(std::to_string(number)));
  }

  Lines expected{"floor/cop 1:1200+3 lost 1197", "floor/raw 1:800+2 lost 798"};
  for (int number = 1; number <= 400; ++number) expected.push_back("floor/marker " + std::to_string(number));
  EXPECT_EQ(told(latest), expected);
  EXPECT_EQ(counts(latest), "1202 messages");
}

TEST_F(InboxLatestTest, AcrossASegment_SkippedScansStayExactBecauseAllWereSeen) {
  Inbox latest = learnt(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  give(latest, "floor/cop", block(1, 3, 3, 2));
  give(latest, "floor/cop", block(2, 0, 4, 3));
  give(latest, "floor/cop", block(2, 4, 4, 4));

  EXPECT_EQ(told(latest), Lines{"floor/cop 2:4+4 lost 10"});
}

TEST_F(InboxLatestTest, WithEndlessEvents_OldestGoAndAreCounted) {
  Inbox latest = learnt(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  for (std::uint64_t number = 0; number < 5000; ++number) give(latest, "floor/marker", marker(std::to_string(number)));

  const Lines lines = told(latest);

  ASSERT_EQ(lines.size(), 4096U);
  EXPECT_EQ(lines[0], "floor/cop 1:0+3");
  EXPECT_EQ(lines[1], "floor/marker 905");
  EXPECT_EQ(lines.back(), "floor/marker 4999");
  EXPECT_EQ(counts(latest), "5002 messages, 905 dropped events");
}

TEST_F(InboxLatestTest, BeforeTheFormat_NewestBlockWaits) {
  Inbox latest = inbox(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  give(latest, "floor/cop", block(1, 3, 3, 2));
  EXPECT_EQ(told(latest), Lines{});

  learn(latest);

  EXPECT_EQ(told(latest), Lines{"floor/cop 1:3+3 lost 3"});
  EXPECT_EQ(counts(latest), "3 messages");
}

TEST_F(InboxLatestTest, BeforeTheFormat_BlockThatDoesNotFitIsCountedOnceAsWhatItIs) {
  Inbox latest = inbox(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1, 1));
  give(latest, "attic/cop", block(1, 0, 3, 1, 1));
  learn(latest);

  EXPECT_EQ(told(latest), Lines{});
  EXPECT_EQ(counts(latest), "1 messages, 1 malformed, 1 unknown");
}

TEST_F(InboxLatestTest, GarbageWhileABlockWaits_DoesNotHarmIt) {
  Inbox latest = learnt(Mode::Latest);
  give(latest, "floor/cop", block(1, 10, 2, 1));

  give_raw(latest, "floor/cop", "\x08garbage");

  const auto message = latest.next(kNowNs);
  ASSERT_TRUE(message && std::holds_alternative<Block>(*message));
  EXPECT_EQ(text_of(std::get<Block>(*message)), "floor/cop 1:10+2");
  EXPECT_EQ(std::get<Block>(*message).column(0)[1], 11.0F);
}

TEST_F(InboxLatestTest, OldDataAfterAStall_IsBehindUntilFreshOnesCome) {
  Inbox latest = learnt(Mode::Latest);
  std::uint64_t scan = 0;
  const auto is_behind = [&](std::int64_t delay_ns, bool is_taken) {
    give(latest, "floor/cop", at(scan++, kNowNs - delay_ns));
    const bool was_behind = latest.is_behind();
    if (is_taken) told(latest);
    return was_behind;
  };
  EXPECT_FALSE(is_behind(500 * kMillisecond, true)) << "what is usual is not known yet";
  EXPECT_FALSE(is_behind(2 * kMillisecond, true));
  EXPECT_FALSE(is_behind(30 * kMillisecond, true)) << "the shortest delay is the usual one";
  EXPECT_TRUE(is_behind(52 * kMillisecond + 2, false)) << "more than 50 ms beyond the usual 2 ms";
  EXPECT_FALSE(is_behind(52 * kMillisecond, false));
  EXPECT_TRUE(is_behind(500 * kMillisecond, false));
  latest.accept_delays();
  EXPECT_FALSE(latest.is_behind());
  told(latest);
  EXPECT_FALSE(is_behind(550 * kMillisecond, false));
  EXPECT_TRUE(is_behind(550 * kMillisecond + 2, false));
}

TEST_F(InboxLatestTest, TimesAtTheEndsOfTheRange_AreNoProblem) {
  Inbox latest = inbox(Mode::Latest);
  v1::StatusSnapshot status = floor_status();
  status.set_boot_id("this-boot");
  give(latest, "dtsd/status", status);
  v1::StreamBlock message = block(1, 0, 2, 1);
  message.mutable_rate()->set_denominator(1'000'000'000'000);
  message.set_host_time_ns(std::numeric_limits<std::int64_t>::min());
  give(latest, "floor/cop", message);
  EXPECT_EQ(told(latest).size(), 1U);
  message.set_host_time_ns(std::numeric_limits<std::int64_t>::max());
  message.set_first_scan(2);
  message.set_sequence(2);

  give(latest, "floor/cop", message);

  std::ignore = latest.is_behind();
  EXPECT_EQ(told(latest).size(), 1U);
}

}  // namespace
}  // namespace dts::client
