// SPDX-License-Identifier: Apache-2.0
#include "unit/libdts/inbox_fixture.h"

#include <limits>

namespace dts::client {
namespace {

using testing::block;
using testing::floor_status;
using testing::marker;

TEST_F(InboxTest, BlockWithKnownFormat_IsHandedOutWithItsFormatAndColumns) {
  Inbox all = inbox(Mode::All);
  learn(all);

  give(all, "floor/cop", block(1, 20, 2, 9));
  const Block got = next_block(all);

  EXPECT_EQ(got.topic, "floor/cop");
  EXPECT_EQ(got.rig, "floor");
  EXPECT_EQ(got.stream, "cop");
  EXPECT_EQ(got.format->channels.at(2).name, "load_n");
  EXPECT_EQ(got.format->channels.at(2).unit, "N");
  EXPECT_EQ(got.rate, (Rate{100, 1}));
  EXPECT_EQ(got.first_scan, 20U);
  EXPECT_FLOAT_EQ(got.column(1)[1], 21.1F);
  EXPECT_FALSE(all.next(kNowNs).has_value());
}

TEST_F(InboxTest, FormatComesLate_BlocksAndEventsWaitInOrder) {
  Inbox all = inbox(Mode::All);
  give(all, "floor/cop", block(1, 0, 2, 1));
  give(all, "floor/marker", marker("between"));
  give(all, "floor/cop", block(1, 2, 2, 2));
  EXPECT_FALSE(all.next(kNowNs).has_value());

  learn(all);

  EXPECT_EQ(next_block(all).first_scan, 0U);
  const auto second = all.next(kNowNs);
  ASSERT_TRUE(second && std::holds_alternative<Event>(*second));
  EXPECT_EQ(std::get<Event>(*second).body->marker().text(), "between");
  EXPECT_EQ(next_block(all).first_scan, 2U);
  EXPECT_FALSE(all.next(kNowNs).has_value());
}

TEST_F(InboxTest, FormatNeverComes_WaitingIsBoundedAndWhatIsDroppedCounts) {
  constexpr std::uint64_t kBlocks = 16384 + 100;
  Inbox all = inbox(Mode::All);
  for (std::uint64_t number = 0; number < kBlocks; ++number) give(all, "floor/raw", block(1, 2 * number, 2, number + 1, 1));

  learn(all);
  const Block first = next_block(all);

  EXPECT_EQ(first.first_scan, 200U);
  EXPECT_EQ(first.lost_scans, 200U);
}

TEST_F(InboxTest, HoleInTheScans_IsCountedBeforeTheBlockAndOnce) {
  Inbox all = inbox(Mode::All);
  learn(all);
  give(all, "floor/cop", block(1, 0, 5, 1));
  EXPECT_EQ(next_block(all).lost_scans, 0U);

  give(all, "floor/cop", block(1, 47, 5, 4));
  EXPECT_EQ(next_block(all).lost_scans, 42U);

  give(all, "floor/cop", block(1, 52, 5, 5));
  EXPECT_EQ(next_block(all).lost_scans, 0U);
}

TEST_F(InboxTest, HolesOfTwoStreams_DoNotMix) {
  Inbox all = inbox(Mode::All);
  learn(all);
  give(all, "floor/cop", block(1, 0, 5, 1));
  give(all, "floor/raw", block(1, 0, 5, 1, 1));
  std::ignore = next_block(all);
  std::ignore = next_block(all);

  give(all, "floor/cop", block(1, 15, 5, 4));
  give(all, "floor/raw", block(1, 5, 5, 2, 1));

  EXPECT_EQ(next_block(all).lost_scans, 10U);
  EXPECT_EQ(next_block(all).lost_scans, 0U);
}

TEST_F(InboxTest, PositionGoesBackwards_DeliveredAndCountedAsInconsistent) {
  Inbox all = inbox(Mode::All);
  learn(all);
  give(all, "floor/cop", block(1, 100, 5, 9));
  std::ignore = next_block(all);

  give(all, "floor/cop", block(1, 50, 5, 10));

  EXPECT_EQ(next_block(all).first_scan, 50U);
  EXPECT_EQ(all.statistics().inconsistent, 1U);
}

TEST_F(InboxTest, Restart_IsToldFirstAndNothingCountsAsLost) {
  Inbox all = inbox(Mode::All);
  learn(all);
  give(all, "floor/cop", block(4, 1000, 5, 99));
  std::ignore = next_block(all);

  give(all, "floor/cop", block(1, 0, 5, 1, 3, 8));
  const auto told = all.next(kNowNs);
  ASSERT_TRUE(told && std::holds_alternative<Restart>(*told));
  EXPECT_EQ(std::get<Restart>(*told).old_instance_id, 7U);
  EXPECT_EQ(std::get<Restart>(*told).new_instance_id, 8U);
  EXPECT_FALSE(all.next(kNowNs).has_value()) << "the new daemon's formats are not known yet";
  EXPECT_EQ(all.status(), nullptr);

  give(all, "dtsd/status", floor_status(8));
  const Block first = next_block(all);
  EXPECT_EQ(first.segment, 1U);
  EXPECT_EQ(first.lost_scans, 0U);
  EXPECT_EQ(all.statistics().restarts, 1U);
}

TEST_F(InboxTest, RestartWithOtherChannelsAndWithoutAStream_OldFormatsAreForgotten) {
  Inbox all = inbox(Mode::All);
  learn(all);
  give(all, "floor/raw", block(1, 0, 1, 1, 1));
  EXPECT_EQ(next_block(all).format->channels.size(), 1U);
  give(all, "floor/cop", block(1, 0, 1, 1));
  EXPECT_EQ(next_block(all).format->channels.size(), 3U);

  v1::StatusSnapshot status = floor_status(8);
  status.mutable_rigs(0)->mutable_rig()->mutable_streams(1)->add_channels()->set_name("w2_v");
  status.mutable_rigs(0)->mutable_rig()->mutable_streams()->DeleteSubrange(0, 1);
  give(all, "dtsd/status", status);
  std::ignore = all.next(kNowNs);
  give(all, "floor/raw", block(1, 0, 1, 1, 2, 8));

  EXPECT_EQ(next_block(all).format->channels.size(), 2U);
  give(all, "floor/cop", block(1, 0, 1, 1, 3, 8));
  EXPECT_FALSE(all.next(kNowNs).has_value());
  EXPECT_EQ(all.statistics().unknown_topics, 1U);
}

TEST_F(InboxTest, SameBoot_AgeIsKnown_OtherwiseAbsent) {
  Inbox all = inbox(Mode::All);
  v1::StatusSnapshot status = floor_status();
  status.set_boot_id("this-boot");
  give(all, "dtsd/status", status);
  v1::StreamBlock message = block(1, 0, 3, 1);
  message.mutable_rate()->set_denominator(3);
  message.set_host_time_ns(kNowNs - 65 * kMillisecond);
  give(all, "floor/cop", message);
  EXPECT_EQ(next_block(all).age_ns, 5 * kMillisecond) << "the newest of three scans at 100 / 3 Hz is 60 ms younger than the first";

  status.set_boot_id("another-boot");
  give(all, "dtsd/status", status);
  message.set_first_scan(3);
  message.set_sequence(2);
  give(all, "floor/cop", message);
  EXPECT_FALSE(next_block(all).age_ns.has_value());
}

TEST_F(InboxTest, Status_IsHandedOutOnlyWhenAskedFor) {
  Inbox quiet = inbox(Mode::All, false);
  EXPECT_EQ(quiet.status(), nullptr);
  learn(quiet);
  EXPECT_FALSE(quiet.next(kNowNs).has_value());
  EXPECT_EQ(quiet.status()->version(), "0.1.0");

  Inbox talkative = inbox(Mode::All, true);
  learn(talkative);
  const auto message = talkative.next(kNowNs);
  ASSERT_TRUE(message && std::holds_alternative<Status>(*message));
  EXPECT_EQ(std::get<Status>(*message).snapshot->instance_id(), 7U);
}

TEST_F(InboxTest, RetainedEventSentAgainForAnotherSubscriber_IsHandedOutOnce) {
  Inbox all = inbox(Mode::All);
  v1::Event change;
  change.set_instance_id(7);
  change.mutable_session()->set_session_id("s1");
  change.mutable_session()->set_state(v1::SESSION_STATE_RUNNING);
  give(all, "floor/session", change);
  EXPECT_TRUE(all.next(kNowNs).has_value());

  give(all, "floor/session", change);
  EXPECT_FALSE(all.next(kNowNs).has_value());

  change.mutable_session()->set_state(v1::SESSION_STATE_STOPPING);
  give(all, "floor/session", change);
  EXPECT_TRUE(all.next(kNowNs).has_value());
}

TEST_F(InboxTest, SameStepOfATrialOrMarkerTwice_IsHandedOutTwiceAndOnlyUnderItsTopic) {
  Inbox all = inbox(Mode::All);
  v1::Event step;
  step.set_instance_id(7);
  step.mutable_trial()->set_kind(v1::TRIAL_EVENT_KIND_GO);
  for (int time = 0; time < 2; ++time) {
    give(all, "floor/trial", step);
    EXPECT_TRUE(all.next(kNowNs).has_value());
    give(all, "floor/marker", marker("step"));
    EXPECT_TRUE(all.next(kNowNs).has_value());
  }

  give(all, "floor/marker", step);
  give(all, "floor/trial", marker("in the wrong topic"));

  EXPECT_FALSE(all.next(kNowNs).has_value());
  EXPECT_EQ(all.statistics().malformed, 2U);
}

TEST_F(InboxTest, MalformedBlocks_AreCountedAndIgnored) {
  Inbox all = inbox(Mode::All);
  learn(all);
  std::vector<v1::StreamBlock> bad(9, block(1, 0, 2, 1));
  bad[0].set_instance_id(0);
  bad[1].set_scan_count(3);
  bad[2].set_scan_count(0);
  bad[3].set_channel_count(4'000'000'000U);
  bad[4].mutable_rate()->set_denominator(0);
  bad[5].clear_rate();
  bad[6].set_quality("\1");
  bad[7].set_first_scan(std::numeric_limits<std::uint64_t>::max());
  bad[8] = block(1, 0, 2, 1, 4);  // well-formed, but the format has three channels

  for (const v1::StreamBlock& message : bad) give(all, "floor/cop", message);
  give_raw(all, "floor/cop", "\xff\xff\xff\xff");
  give_raw(all, "floor/cop", std::string(2U << 20U, '\0'));

  EXPECT_FALSE(all.next(kNowNs).has_value());
  EXPECT_EQ(all.statistics().malformed, bad.size() + 2);
  EXPECT_EQ(all.statistics().restarts, 0U);
}

TEST_F(InboxTest, MalformedEventsAndStatus_AreCountedAndIgnored) {
  Inbox all = inbox(Mode::All, true);
  give(all, "floor/gap", marker("in the wrong topic"));
  give(all, "floor/marker", v1::Event());
  v1::StatusSnapshot status = floor_status();
  status.mutable_rigs(0)->mutable_rig()->mutable_streams(0)->clear_channels();
  give(all, "dtsd/status", status);

  EXPECT_FALSE(all.next(kNowNs).has_value());
  EXPECT_EQ(all.statistics().malformed, 3U);
}

TEST_F(InboxTest, UnknownTopics_AreCountedAndIgnored) {
  Inbox all = inbox(Mode::All);
  learn(all);

  give(all, "floor/spectrum", block(1, 0, 2, 1));
  give(all, "chair/cop", block(1, 0, 2, 1));  // no such rig in the status

  EXPECT_FALSE(all.next(kNowNs).has_value());
  EXPECT_EQ(all.statistics().unknown_topics, 2U);
}

TEST_F(InboxTest, GarbageWhileABlockWaits_DoesNotHarmIt) {
  Inbox latest = inbox(Mode::Latest);
  learn(latest);
  give(latest, "floor/cop", block(1, 10, 2, 1));

  give_raw(latest, "floor/cop", "\x08garbage");

  const Block got = next_block(latest);
  EXPECT_EQ(got.first_scan, 10U);
  EXPECT_FLOAT_EQ(got.column(0)[1], 11.0F);
}

}  // namespace
}  // namespace dts::client
