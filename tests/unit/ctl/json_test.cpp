// SPDX-License-Identifier: Apache-2.0
#include "ctl/json.h"

#include <gtest/gtest.h>

#include <limits>

#include "ctl/reach_reading.h"

namespace dts::ctl {
namespace {

TEST(ToJson, EmptyMessage_HasOnlyWhatIsDefinedAtZero) {
  const cli::Json json = to_json(v1::RigStatus());

  EXPECT_EQ(json.at("lost_scans_total"), 0);
  for (const char* key : {"device", "device_message", "measured_rate_hz", "pipeline_us_per_scan", "tare", "session", "rig"}) {
    EXPECT_FALSE(json.contains(key)) << key;
  }
}

TEST(ToJson, NumbersThatAreNotFinite_AreAbsentOrNullInLists) {
  v1::RigStatus status;
  status.set_nominal_rate_hz(std::numeric_limits<double>::quiet_NaN());
  v1::TareResponse tare;
  tare.add_baseline_mm(std::numeric_limits<double>::infinity());

  EXPECT_FALSE(to_json(status).contains("nominal_rate_hz"));
  EXPECT_EQ(to_json(tare).dump(), R"({"baseline_mm":[null]})");
}

TEST(ToJson, LargeNumbers_AreExactNumbers) {
  v1::StatusSnapshot status;
  status.set_instance_id(std::numeric_limits<std::uint64_t>::max());
  status.set_host_time_ns(std::numeric_limits<std::int64_t>::min());

  const cli::Json json = cli::Json::parse(cli::document(to_json(status)));

  EXPECT_EQ(json.at("instance_id").get<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(json.at("host_time_ns").get<std::int64_t>(), std::numeric_limits<std::int64_t>::min());
}

TEST(ToJson, MapOfTexts_IsAnObject) {
  v1::TrialChange change;
  (*change.mutable_labels())["eyes"] = "open";

  const cli::Json json = to_json(change);

  EXPECT_EQ(json.at("labels").dump(), R"({"eyes":"open"})");
  EXPECT_FALSE(json.contains("target_cm"));
}

TEST(ToJson, FieldOfWords_HasNoRange) {
  v1::ProtocolField field;
  field.set_name("side");
  EXPECT_TRUE(to_json(field).contains("minimum")) << "0 is a limit of a number";

  field.add_choices("left");
  EXPECT_FALSE(to_json(field).contains("minimum"));
  EXPECT_FALSE(to_json(field).contains("maximum"));
}

TEST(ToJson, ReachThatHasJustBegun_HasNoPointsOfLater) {
  v1::Reach reach;
  reach.mutable_p1()->set_scan(1200);
  reach.mutable_p1()->set_value_mm(3.25);
  for (v1::ReachPoint* point : {reach.mutable_p2(), reach.mutable_p3()}) point->set_value_mm(std::numeric_limits<double>::quiet_NaN());

  const cli::Json json = to_json(reach);

  EXPECT_EQ(json.at("p1").dump(), R"({"scan":1200,"value_mm":3.25})");
  EXPECT_FALSE(json.contains("p2"));
  EXPECT_FALSE(json.contains("p3"));
}

TEST(ToJson, TrialWithoutATarget_ExpectsNothing) {
  v1::TrialResult result;
  result.set_expected_class(-1);

  EXPECT_FALSE(to_json(result).contains("target_cm"));
  EXPECT_FALSE(to_json(result).contains("expected_class"));

  result.set_target_cm(80.4);
  result.set_expected_class(0);
  EXPECT_EQ(to_json(result).at("target_cm"), 80.4);
  EXPECT_EQ(to_json(result).at("expected_class"), 0);
}

/// A minor reach is at most class 1, whatever is the most probable.
TEST(MovementText, Probability_IsThatOfTheClass) {
  v1::TrunkMovement movement;
  movement.set_number(3);
  movement.set_trunk_class(1);
  for (const double probability : {0.25, 0.75, 0.0}) movement.add_probability(probability);
  movement.set_trunk_deg(std::numeric_limits<double>::quiet_NaN());

  EXPECT_EQ(movement_text(movement), "reach 3: minor trunk movement, p 0.25");
}

TEST(ToJson, NoSessionYet_OnlyItsState) {
  v1::SessionInfo session;
  session.set_rig("floor");
  session.set_state(v1::SESSION_STATE_IDLE);

  EXPECT_EQ(to_json(session).dump(), R"({"rig":"floor","state":"idle"})");
}

TEST(EnumeratorWord, KnownAndUnknownNumbers) {
  EXPECT_EQ(enumerator_word(*v1::DeviceState_descriptor(), v1::DEVICE_STATE_STREAMING), "streaming");
  EXPECT_EQ(enumerator_word(*v1::GapReason_descriptor(), v1::GAP_REASON_RING_FULL), "ring_full");
  EXPECT_EQ(enumerator_word(*v1::ErrorCode_descriptor(), v1::ERROR_CODE_NOT_FOUND), "not_found");
  EXPECT_EQ(enumerator_word(*v1::DeviceState_descriptor(), 99), "unknown");
}

TEST(QualityWords, EachBit_IsAWord) {
  EXPECT_TRUE(quality_words(0).empty());
  EXPECT_EQ(quality_words(v1::QUALITY_RAIL | v1::QUALITY_UNTARED), (std::vector<std::string>{"rail", "untared"}));
  EXPECT_EQ(quality_words(128), std::vector<std::string>{"substituted"});
}

TEST(BitWords, OfALaterVersion_AreUnknown) {
  EXPECT_EQ(bit_words(*v1::ReachFlag_descriptor(), 1U | 1U << 31U), (std::vector<std::string>{"minor", "unknown"}));
}

}  // namespace
}  // namespace dts::ctl
