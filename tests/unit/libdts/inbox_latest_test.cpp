// SPDX-License-Identifier: Apache-2.0
#include "unit/libdts/inbox_fixture.h"

#include <limits>

namespace dts::client {
namespace {

using testing::block;
using testing::floor_status;
using testing::marker;

using InboxLatestTest = InboxTest;

TEST_F(InboxLatestTest, AfterAStall_NewestBlockOfEachStreamAndExactSkippedScans) {
  Inbox latest = inbox(Mode::Latest);
  learn(latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  std::ignore = next_block(latest);
  for (std::uint64_t number = 1; number <= 400; ++number) {
    give(latest, "floor/cop", block(1, 3 * number, 3, number + 1));
    give(latest, "floor/raw", block(1, 2 * number, 2, number, 1));
  }

  const Block cop = next_block(latest);
  EXPECT_EQ(cop.first_scan, 1200U);
  EXPECT_EQ(cop.lost_scans, 1197U);
  EXPECT_TRUE(cop.is_lost_exact);
  const Block raw = next_block(latest);
  EXPECT_EQ(raw.first_scan, 800U);
  EXPECT_EQ(raw.lost_scans, 798U);
  EXPECT_FALSE(latest.next(kNowNs).has_value());
}

TEST_F(InboxLatestTest, AcrossASegment_SkippedScansStayExactBecauseAllWereSeen) {
  Inbox latest = inbox(Mode::Latest);
  learn(latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  std::ignore = next_block(latest);
  give(latest, "floor/cop", block(1, 3, 3, 2));
  give(latest, "floor/cop", block(2, 0, 4, 3));
  give(latest, "floor/cop", block(2, 4, 4, 4));

  const Block got = next_block(latest);

  EXPECT_EQ(got.segment, 2U);
  EXPECT_EQ(got.lost_scans, 7U);
  EXPECT_TRUE(got.is_lost_exact);
}

TEST_F(InboxLatestTest, WithEvents_KeepsEveryEvent) {
  Inbox latest = inbox(Mode::Latest);
  learn(latest);
  for (std::uint64_t number = 0; number < 10; ++number) {
    give(latest, "floor/cop", block(1, number, 1, number + 1));
    give(latest, "floor/marker", marker("m", number));
  }

  int events = 0;
  int blocks = 0;
  while (const auto message = latest.next(kNowNs)) std::holds_alternative<Event>(*message) ? ++events : ++blocks;

  EXPECT_EQ(events, 10);
  EXPECT_EQ(blocks, 1);
}

TEST_F(InboxLatestTest, WithEndlessEvents_OldestGoAndAreCounted) {
  Inbox latest = inbox(Mode::Latest);
  for (std::uint64_t number = 0; number < 5000; ++number) give(latest, "floor/marker", marker("m", number));

  const auto first = latest.next(kNowNs);

  ASSERT_TRUE(first && std::holds_alternative<Event>(*first));
  EXPECT_EQ(std::get<Event>(*first).body->scan(), 5000U - 4096U);
  EXPECT_EQ(latest.statistics().dropped_events, 5000U - 4096U);
}

TEST_F(InboxLatestTest, BeforeTheFormat_BlockThatDoesNotFitIsCountedOnce) {
  Inbox latest = inbox(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1, 1));
  learn(latest);

  EXPECT_EQ(latest.statistics().malformed, 1U);
  EXPECT_EQ(latest.statistics().messages, 1U) << "the status";
}

TEST_F(InboxLatestTest, BeforeTheFormat_NewestBlockWaits) {
  Inbox latest = inbox(Mode::Latest);
  give(latest, "floor/cop", block(1, 0, 3, 1));
  give(latest, "floor/cop", block(1, 3, 3, 2));
  EXPECT_FALSE(latest.next(kNowNs).has_value());

  learn(latest);

  const Block got = next_block(latest);
  EXPECT_EQ(got.first_scan, 3U);
  EXPECT_EQ(got.lost_scans, 3U);
}

TEST_F(InboxLatestTest, OldDataAfterAStall_IsBehindUntilFreshOnesCome) {
  Inbox latest = inbox(Mode::Latest);
  learn(latest);
  const auto at = [](std::uint64_t first_scan, std::uint64_t sequence, std::int64_t host_time_ns) {
    v1::StreamBlock message = block(1, first_scan, 1, sequence);
    message.set_host_time_ns(host_time_ns);
    return message;
  };
  give(latest, "floor/cop", at(0, 1, kNowNs - 2 * kMillisecond));
  EXPECT_FALSE(latest.is_behind());
  std::ignore = next_block(latest);

  give(latest, "floor/cop", at(1, 2, kNowNs - 52 * kMillisecond - 2));
  EXPECT_TRUE(latest.is_behind()) << "more than 50 ms beyond the usual 2 ms";

  give(latest, "floor/cop", at(2, 3, kNowNs - 52 * kMillisecond));
  EXPECT_FALSE(latest.is_behind());
}

TEST_F(InboxLatestTest, DelayHasGrownForGood_IsAcceptedAsUsual) {
  Inbox latest = inbox(Mode::Latest);
  learn(latest);
  give(latest, "floor/cop", block(1, 0, 1, 1), kMillisecond);
  std::ignore = next_block(latest);
  give(latest, "floor/cop", block(1, 1, 1, 2), 500 * kMillisecond);
  ASSERT_TRUE(latest.is_behind());

  latest.accept_delays();
  std::ignore = next_block(latest);
  give(latest, "floor/cop", block(1, 2, 1, 3), 501 * kMillisecond);

  EXPECT_TRUE(latest.is_behind() == false);
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
  std::ignore = next_block(latest);
  message.set_host_time_ns(std::numeric_limits<std::int64_t>::max());
  message.set_first_scan(2);
  message.set_sequence(2);

  give(latest, "floor/cop", message);

  std::ignore = latest.is_behind();
  EXPECT_EQ(next_block(latest).first_scan, 2U);
}

}  // namespace
}  // namespace dts::client
