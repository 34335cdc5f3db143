// SPDX-License-Identifier: Apache-2.0
// What the centre receives while the clinic works: beats, and streams for those who may watch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fleet/forward/beat.h"
#include "fleet/forward/event_mask.h"
#include "fleet/forward/viewers.h"
#include "fleet/wire/messages.h"
#include "unit/fleet/canary.h"

namespace dts::fleet::forward {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

v1::StatusSnapshot status_of_floor() {
  v1::StatusSnapshot status;
  auto& rig = *status.add_rigs();
  rig.mutable_rig()->set_name("floor");
  rig.mutable_rig()->add_published("cop");
  rig.mutable_session()->set_state(v1::SESSION_STATE_IDLE);
  return status;
}

v1::LiveRequest request(const std::vector<std::string>& topics, const std::string& who = "ann") {
  v1::LiveRequest request;
  for (const auto& topic : topics) request.add_topics(topic);
  request.set_who(who);
  return request;
}

TEST(BeatOf, CanaryInEveryFieldOfTheStatus_OnlyNamesOfProgramsLeave) {
  v1::StatusSnapshot status;
  fill_with_canaries(status);
  const auto beat = beat_of(&status, {}, "0.2.0", 5);
  EXPECT_THAT(canaries_in(beat.ShortDebugString()),
              testing::UnorderedElementsAre("canary-version", "canary-name", "canary-kind", "canary-session_id", "canary-calibration",
                                            "canary-published"));
}

TEST(BeatOf, SilentDaemon_IsTold) {
  v1::Backlog backlog;
  backlog.set_files(3);
  const auto beat = beat_of(nullptr, backlog, "0.2.0", 5);
  EXPECT_FALSE(beat.has_daemon());
  EXPECT_EQ(beat.forwarder_version(), "0.2.0");
  EXPECT_EQ(beat.utc_ns(), 5);
  EXPECT_EQ(beat.backlog().files(), 3U);
  EXPECT_EQ(beat.rigs_size(), 0);
}

TEST(BeatOf, Status_IsAcceptedByTheCentre) {
  auto status = status_of_floor();
  status.set_version("0.2.0");
  status.mutable_disk()->set_free_bytes(17);
  const auto beat = wire::decode_beat(beat_of(&status, {}, "0.2.0", 5).SerializeAsString());
  ASSERT_TRUE(beat) << core::to_string(beat.error());
  EXPECT_TRUE(beat->has_daemon());
  EXPECT_EQ(beat->rigs(0).rig(), "floor");
  EXPECT_THAT(beat->rigs(0).streams(), ElementsAre("cop"));
  EXPECT_EQ(beat->disk().free_bytes(), 17U);
}

TEST(IsSessionRunning, States) {
  auto status = status_of_floor();
  EXPECT_FALSE(is_session_running(status));
  for (const auto state : {v1::SESSION_STATE_STARTING, v1::SESSION_STATE_SETTLING, v1::SESSION_STATE_RUNNING, v1::SESSION_STATE_STOPPING}) {
    status.mutable_rigs(0)->mutable_session()->set_state(state);
    EXPECT_TRUE(is_session_running(status));
  }
  status.mutable_rigs(0)->mutable_session()->set_state(v1::SESSION_STATE_FAILED);
  EXPECT_FALSE(is_session_running(status));
}

TEST(MaskStatus, CanaryInEveryField_OnlyNamesOfProgramsAndSubjectIdsLeave) {
  v1::StatusSnapshot status;
  fill_with_canaries(status);
  auto with_labels = status;
  mask_status(status, {});
  const std::string left = status.SerializeAsString();
  for (const char* text : {"canary-key", "canary-value", "canary-message", "canary-device_message", "canary-problem", "canary-directory",
                           "canary-file", "canary-notices", "canary-device_uri"}) {
    EXPECT_THAT(left, testing::Not(HasSubstr(text)));
  }
  EXPECT_TRUE(status.rigs(0).session().fields().empty());
  EXPECT_EQ(status.rigs(0).session().subject(), "canary-subject");
  EXPECT_EQ(status.rigs(0).session().trial().condition(), "canary-condition");
  EXPECT_EQ(status.rigs(0).rig().streams(0).name(), "canary-name");
  EXPECT_EQ(status.rigs(0).session().label(), "");
  EXPECT_EQ(status.rigs(0).rig().sensors(0).label(), "canary-label");
  mask_status(with_labels, {.labels = true});
  EXPECT_EQ(with_labels.rigs(0).session().label(), "canary-label");
}

class ViewersTest : public testing::Test {
 protected:
  v1::StatusSnapshot status_ = status_of_floor();
  Viewers viewers_{true, core::Log()};
  Viewers::Time now_ = Viewers::Time(std::chrono::seconds(1000));
};

TEST_F(ViewersTest, Request_LeasesItsTopicsFor10Seconds) {
  EXPECT_EQ(viewers_.handle(request({"floor/cop", "floor/marker"}), &status_, now_).lease_s(), 10U);
  EXPECT_THAT(viewers_.topics(), ElementsAre("floor/cop", "floor/marker"));
  EXPECT_THAT(viewers_.names(), ElementsAre("ann"));
  viewers_.expire(now_ + std::chrono::seconds(9));
  EXPECT_THAT(viewers_.topics(), ElementsAre("floor/cop", "floor/marker"));
  (void)viewers_.handle(request({"floor/cop"}, "bob"), &status_, now_ + std::chrono::seconds(9));
  viewers_.expire(now_ + std::chrono::seconds(10));
  EXPECT_THAT(viewers_.topics(), ElementsAre("floor/cop"));
  EXPECT_THAT(viewers_.names(), ElementsAre("bob"));
  viewers_.expire(now_ + std::chrono::seconds(19));
  EXPECT_THAT(viewers_.topics(), IsEmpty());
}

TEST_F(ViewersTest, TopicThatTheClinicDoesNotPublish_IsRefused) {
  for (const char* topic : {"floor/raw", "chair/cop", "floor/", "floor", "dtsd/log", "floor/cop/x", ""}) {
    EXPECT_THAT(viewers_.handle(request({"floor/cop", topic}), &status_, now_).refusal().reason(), HasSubstr("no topic")) << topic;
  }
  EXPECT_THAT(viewers_.topics(), IsEmpty());
}

TEST_F(ViewersTest, StatusOfTheDaemon_IsATopic) {
  EXPECT_TRUE(viewers_.handle(request({"dtsd/status"}), &status_, now_).has_lease_s());
  EXPECT_THAT(viewers_.topics(), ElementsAre("dtsd/status"));
}

TEST_F(ViewersTest, ClinicThatDoesNotAllowIt_Refuses) {
  Viewers closed(false, core::Log());
  EXPECT_EQ(closed.handle(request({"floor/cop"}), &status_, now_).refusal().reason(), "the clinic does not allow it");
  EXPECT_THAT(closed.topics(), IsEmpty());
}

TEST_F(ViewersTest, SilentDaemon_Refuses) {
  EXPECT_THAT(viewers_.handle(request({"floor/cop"}), nullptr, now_).refusal().reason(), HasSubstr("dtsd"));
}

TEST_F(ViewersTest, TooManyViewers_AreRefused) {
  for (int viewer = 0; viewer < 64; ++viewer) (void)viewers_.handle(request({"floor/cop"}, "v" + std::to_string(viewer)), &status_, now_);
  EXPECT_TRUE(viewers_.handle(request({"floor/cop"}, "one more"), &status_, now_).has_refusal());
  EXPECT_FALSE(viewers_.handle(request({"floor/cop"}, "v7"), &status_, now_).has_refusal());
}

}  // namespace
}  // namespace dts::fleet::forward
