// SPDX-License-Identifier: Apache-2.0
#include "unit/libdts/inbox_fixture.h"

#include <limits>

namespace dts::client {
namespace {

using testing::block;
using testing::floor_status;
using testing::from_text;
using testing::marker;

constexpr std::size_t kMostHeld = 16384;

TEST_F(InboxTest, Block_HasAllThatWasSentAndItsFormat) {
  Inbox all = learnt(Mode::All);
  v1::StreamBlock sent = block(3, 20, 2, 9);
  sent.set_host_time_ns(5);
  sent.set_host_time_uncertainty_ns(6);
  sent.set_lost_scans_total(7);
  sent.set_dropped_blocks_total(8);
  sent.set_quality(std::string("\1\0\4", 3));
  give(all, "floor/cop", sent);

  const auto message = all.next(kNowNs);

  ASSERT_TRUE(message && std::holds_alternative<Block>(*message));
  const Block& got = std::get<Block>(*message);
  EXPECT_EQ(text_of(got), "floor/cop 3:20+2");
  EXPECT_EQ(got.rig, "floor");
  EXPECT_EQ(got.stream, "cop");
  EXPECT_EQ(got.format->name, "cop");
  EXPECT_EQ(got.format->rate, (Rate{100, 1}));
  EXPECT_EQ(got.format->channels.at(2).name, "load_n");
  EXPECT_EQ(got.format->channels.at(2).unit, "N");
  EXPECT_EQ(got.rate, (Rate{100, 1}));
  EXPECT_EQ(got.host_time_ns, 5);
  EXPECT_EQ(got.host_time_uncertainty_ns, 6);
  EXPECT_EQ(got.sequence, 9U);
  EXPECT_EQ(got.lost_before_pipeline_total, 7U);
  EXPECT_EQ(got.dropped_blocks_total, 8U);
  EXPECT_EQ(std::vector<float>(got.values.begin(), got.values.end()), (std::vector<float>{20.0F, 21.0F, 20.1F, 21.1F, 20.2F, 21.2F}));
  EXPECT_EQ(std::vector<std::uint8_t>(got.quality.begin(), got.quality.end()), (std::vector<std::uint8_t>{1, 0, 4}));
  EXPECT_EQ(got.body->SerializeAsString(), sent.SerializeAsString());
  EXPECT_EQ(told(all), Lines{});
}

TEST_F(InboxTest, FormatComesLate_BlocksAndEventsWaitInOrder) {
  Inbox all = inbox(Mode::All);
  give(all, "floor/marker", marker("at once"));
  give(all, "floor/cop", block(1, 0, 2, 1));
  give(all, "floor/marker", marker("between"));
  give(all, "floor/cop", block(1, 2, 2, 2));
  EXPECT_EQ(told(all), Lines{"floor/marker at once"});
  EXPECT_EQ(counts(all), "1 messages");

  learn(all);

  EXPECT_EQ(told(all), (Lines{"floor/cop 1:0+2", "floor/marker between", "floor/cop 1:2+2"}));
  EXPECT_EQ(counts(all), "5 messages");
}

TEST_F(InboxTest, FormatNeverComes_WaitingIsBoundedAndWhatIsDroppedCounts) {
  for (const std::uint64_t beyond : {0U, 1U, 100U}) {
    Inbox all = inbox(Mode::All);
    for (std::uint64_t number = 0; number < kMostHeld + beyond; ++number) give(all, "floor/raw", block(1, 2 * number, 2, number + 1, 1));
    learn(all);
    const std::string lost = std::to_string(2 * beyond);
    EXPECT_EQ(told(all).front(), "floor/raw 1:" + lost + "+2" + (beyond > 0 ? " lost " + lost : ""));
  }
  Inbox all = inbox(Mode::All);
  give(all, "floor/raw", block(1, 0, 2, 1, 1));
  for (std::size_t count = 0; count < kMostHeld + 1; ++count) give(all, "floor/marker", marker("m"));
  learn(all);
  EXPECT_EQ(counts(all), "1 messages, 1 dropped events");
}

TEST_F(InboxTest, FormatNeverComes_WaitingIsBoundedInBytes) {
  v1::StreamBlock large = block(1, 0, 65536, 1, 1);
  const auto numbered = [&large](std::uint64_t number) {
    large.set_first_scan((std::uint64_t{1} << 30U) + number * 65536);
    large.set_sequence(1000 + number);
    return large;
  };
  const std::size_t most = (32U << 20U) / numbered(0).ByteSizeLong();
  Inbox all = inbox(Mode::All);
  for (std::uint64_t number = 0; number < most + 3; ++number) give(all, "floor/raw", numbered(number));

  learn(all);

  const Lines lines = told(all);
  EXPECT_EQ(lines.size(), most);
  EXPECT_EQ(lines.front(), "floor/raw 1:" + std::to_string((1U << 30U) + 3 * 65536) + "+65536 lost " + std::to_string(3 * 65536));
}

TEST_F(InboxTest, Holes_AreCountedOnceBeforeTheBlockAndOfEachStream) {
  Inbox all = learnt(Mode::All);
  give(all, "floor/cop", block(1, 0, 5, 1));
  EXPECT_EQ(told(all), Lines{"floor/cop 1:0+5"});
  give(all, "floor/raw", block(1, 0, 5, 1, 1));
  EXPECT_EQ(told(all), Lines{"floor/raw 1:0+5"});
  give(all, "floor/cop", block(1, 47, 5, 4));
  EXPECT_EQ(told(all), Lines{"floor/cop 1:47+5 lost 42"});
  give(all, "floor/raw", block(1, 5, 5, 2, 1));
  EXPECT_EQ(told(all), Lines{"floor/raw 1:5+5"});
  give(all, "floor/cop", block(2, 40, 5, 8));
  EXPECT_EQ(told(all), Lines{"floor/cop 2:40+5 lost at least 40"});
  give(all, "floor/cop", block(2, 45, 5, 9));
  EXPECT_EQ(told(all), Lines{"floor/cop 2:45+5"});
  EXPECT_EQ(counts(all), "7 messages");
  give(all, "floor/cop", block(2, 30, 5, 10));
  EXPECT_EQ(told(all), Lines{"floor/cop 2:30+5 lost at least 0"});
  EXPECT_EQ(counts(all), "8 messages, 1 inconsistent");
}

TEST_F(InboxTest, Restart_IsToldFirstAndNothingCountsAsLost) {
  Inbox all = learnt(Mode::All);
  give(all, "floor/cop", block(4, 1000, 5, 99));
  EXPECT_EQ(told(all), Lines{"floor/cop 4:1000+5"});

  give(all, "floor/marker", marker("of the old one"));
  give(all, "floor/cop", block(4, 1009, 5, 100));
  give(all, "floor/cop", block(1, 0, 5, 1, 3, 8));
  EXPECT_EQ(told(all), (Lines{"floor/marker of the old one", "restart 7 8"})) << "the new daemon's formats are not known yet";
  EXPECT_EQ(all.status(), nullptr);

  give(all, "dtsd/status", floor_status(8));
  EXPECT_EQ(told(all), Lines{"floor/cop 1:0+5"});
  EXPECT_EQ(counts(all), "6 messages, 1 restarts");
}

TEST_F(InboxTest, RestartWithOtherChannelsAndWithoutAStream_OldFormatsAreForgotten) {
  Inbox all = learnt(Mode::All);
  give(all, "floor/raw", block(1, 0, 1, 1, 1));
  give(all, "floor/cop", block(1, 0, 1, 1));
  EXPECT_EQ(told(all), (Lines{"floor/raw 1:0+1", "floor/cop 1:0+1"}));

  v1::StatusSnapshot status = floor_status(8);
  status.mutable_rigs(0)->mutable_rig()->mutable_streams(1)->add_channels()->set_name("w2_v");
  status.mutable_rigs(0)->mutable_rig()->mutable_streams()->DeleteSubrange(0, 1);
  give(all, "dtsd/status", status);
  give(all, "floor/raw", block(1, 0, 1, 1, 2, 8));
  give(all, "floor/cop", block(1, 0, 1, 1, 3, 8));

  EXPECT_EQ(told(all), (Lines{"restart 7 8", "floor/raw 1:0+1"}));
  EXPECT_EQ(counts(all), "5 messages, 1 unknown, 1 restarts");
}

TEST_F(InboxTest, SameBoot_AgeIsKnown_OtherwiseAbsent) {
  RecordProperty("requirement", "PUB-3");
  v1::StatusSnapshot status = floor_status();
  v1::StreamBlock message = block(1, 0, 3, 1);
  message.mutable_rate()->set_denominator(3);
  message.set_host_time_ns(kNowNs - 65 * kMillisecond);
  for (const std::string boot : {"this-boot", "another-boot", ""}) {
    Inbox all = inbox(Mode::All);
    status.set_boot_id(boot);
    give(all, "dtsd/status", status);
    give(all, "floor/cop", message);
    EXPECT_EQ(told(all), Lines{boot == "this-boot" ? "floor/cop 1:0+3 age 5000000 ns" : "floor/cop 1:0+3"})
        << "the newest of three scans at 100 / 3 Hz is 60 ms younger than the first";
  }
  Inbox without_boot(Mode::All, false, "");
  give(without_boot, "dtsd/status", floor_status());
  give(without_boot, "floor/cop", message);
  EXPECT_EQ(told(without_boot), Lines{"floor/cop 1:0+3"});
}

TEST_F(InboxTest, Status_IsHandedOutOnlyWhenAskedForAndTheNewestOnce) {
  Inbox all = inbox(Mode::All);
  EXPECT_EQ(all.status(), nullptr);
  learn(all);
  EXPECT_EQ(told(all), Lines{});
  EXPECT_EQ(all.status()->version(), "0.1.0");

  all.hand_out_status(true);
  learn(all);
  give(all, "floor/marker", marker("m"));
  learn(all);
  EXPECT_EQ(told(all), (Lines{"status 7", "floor/marker m"}));
  learn(all);
  EXPECT_EQ(told(all), Lines{"status 7"});
  give(all, "dtsd/status", floor_status(8));
  EXPECT_EQ(told(all), (Lines{"restart 7 8", "status 8"}));
}

TEST_F(InboxTest, RetainedEventSentAgainForAnotherSubscriber_IsHandedOutOnce) {
  Inbox all = inbox(Mode::All);
  const auto session = from_text<v1::Event>("instance_id: 7 session { session_id: 's1' state: SESSION_STATE_RUNNING }");
  const auto device = from_text<v1::Event>("instance_id: 7 device { state: DEVICE_STATE_GONE }");
  const auto changed = from_text<v1::Event>("instance_id: 7 session { session_id: 's1' state: SESSION_STATE_STOPPING }");
  const auto told_of = [&](const std::string& topic, const v1::Event& event) {
    give(all, topic, event);
    return told(all).size();
  };
  EXPECT_EQ(told_of("floor/session", session), 1U);
  EXPECT_EQ(told_of("floor/session", session), 0U);
  EXPECT_EQ(told_of("chair/session", session), 1U);
  EXPECT_EQ(told_of("floor/device", device), 1U);
  EXPECT_EQ(told_of("floor/device", device), 0U);
  EXPECT_EQ(told_of("floor/session", changed), 1U);
  EXPECT_EQ(told_of("floor/session", session), 1U);
  const auto step = from_text<v1::Event>("instance_id: 7 trial { step: TRIAL_EVENT_KIND_GO }");
  for (int time = 0; time < 2; ++time) EXPECT_EQ(told_of("floor/trial", step), 1U) << "a step of a trial may come twice";
  give(all, "dtsd/status", floor_status(8));
  EXPECT_EQ(told(all), Lines{"restart 7 8"});
  auto after_restart = session;
  after_restart.set_instance_id(8);
  EXPECT_EQ(told_of("floor/session", after_restart), 1U);
  EXPECT_EQ(told_of("floor/session", after_restart), 0U);
}

TEST_F(InboxTest, EventBody_IsTakenUnderItsOwnTopicOnly) {
  const std::vector<std::pair<std::string, std::string>> bodies{{"gap { }", "gap"},
                                                                {"marker { }", "marker"},
                                                                {"trigger { }", "trigger"},
                                                                {"device { }", "device"},
                                                                {"session { }", "session"},
                                                                {"trial { }", "trial"},
                                                                {"trial_result { }", "trial"},
                                                                {"reach { }", "reach"},
                                                                {"movement { }", "class"},
                                                                {"sway { }", "sway"},
                                                                {"", "(none)"}};
  for (const auto& [body, own] : bodies) {
    for (const std::string topic : {"gap", "marker", "trigger", "device", "session", "trial", "reach", "class", "sway"}) {
      Inbox all = inbox(Mode::All);
      give(all, "floor/" + topic, from_text<v1::Event>("instance_id: 7 " + body));
      EXPECT_EQ(counts(all), topic == own ? "1 messages" : "1 malformed") << body << " under " << topic;
      EXPECT_EQ(told(all).size(), topic == own ? 1U : 0U);
    }
  }
}

TEST_F(InboxTest, MalformedMessages_AreCountedAndIgnored) {
  Inbox all = learnt(Mode::All);
  std::vector<v1::StreamBlock> bad(8, block(1, 0, 2, 1));
  bad[0].set_instance_id(0);
  bad[1].set_scan_count(3);
  bad[2].set_scan_count(0);
  bad[3].set_channel_count(4'000'000'000U);
  bad[4].clear_rate();
  bad[5].set_quality("\1");
  bad[6].set_first_scan(std::numeric_limits<std::uint64_t>::max());
  bad[7] = block(1, 0, 2, 1, 4);  // well-formed, but the format has three channels
  for (const v1::StreamBlock& message : bad) give(all, "floor/cop", message);
  give_raw(all, "floor/cop", "\xff\xff\xff\xff");
  give(all, "floor/marker", marker("of no daemon", 5, 0));
  give_raw(all, "floor/marker", "\xff\xff\xff\xff");
  v1::StatusSnapshot status = floor_status();
  status.mutable_rigs(0)->mutable_rig()->mutable_streams(0)->clear_channels();
  give(all, "dtsd/status", status);
  give_raw(all, "dtsd/status", "\xff\xff\xff\xff");

  EXPECT_EQ(told(all), Lines{});
  EXPECT_EQ(counts(all), "1 messages, 13 malformed");
  EXPECT_NE(all.status(), nullptr) << "of the good one";
}

TEST_F(InboxTest, MessageOfTheLargestSize_IsTakenAndALargerOneIsNot) {
  Inbox all = inbox(Mode::All);
  v1::Event event = marker("");
  event.mutable_marker()->mutable_text()->assign((1U << 20U) - 100, 'x');
  event.mutable_marker()->mutable_text()->append((1U << 20U) - event.ByteSizeLong(), 'x');
  give(all, "floor/marker", event);
  EXPECT_EQ(counts(all), "1 messages");
  event.mutable_marker()->mutable_text()->append("x");
  give(all, "floor/marker", event);
  EXPECT_EQ(counts(all), "1 messages, 1 malformed");
}

TEST_F(InboxTest, UnknownTopics_AreCountedAndIgnored) {
  Inbox all = learnt(Mode::All);
  give(all, "floor/spectrum", block(1, 0, 2, 1));
  give(all, "chair/cop", block(1, 0, 2, 1));  // no such rig in the status
  EXPECT_EQ(told(all), Lines{});
  EXPECT_EQ(counts(all), "1 messages, 2 unknown");

  Inbox many = inbox(Mode::All);
  for (int rig = 0; rig < 1025; ++rig) give(many, "rig" + std::to_string(rig) + "/marker", marker("m"));
  EXPECT_EQ(counts(many), "1024 messages, 1 unknown");
}

}  // namespace
}  // namespace dts::client
