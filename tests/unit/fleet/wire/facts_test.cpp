// SPDX-License-Identifier: Apache-2.0
// Which facts of a session leave the clinic.
#include "fleet/wire/facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "fleet/wire/messages.h"
#include "unit/fleet/canary.h"

namespace dts::fleet::wire {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

v1::SessionRecord session_with_canaries() {
  v1::SessionRecord session;
  fill_with_canaries(session, {}, {"dts.v1.SessionRecord.fields"});
  (*session.mutable_fields())["weight_kg"] = "canary-weight";
  (*session.mutable_fields())["arm_length_cm"] = "canary-arm";
  return session;
}

/// Fields whose text every clinic sends. A new one in this list is a decision on privacy.
const std::set<std::string> kSent{"canary-session_id", "canary-rig",     "canary-protocol",         "canary-subject", "canary-state",
                                  "canary-condition",  "canary-outcome", "canary-recorded_outcome", "canary-name",    "canary-unit"};

TEST(FactsOf, CanaryInEveryField_OnlyTheListedOnesLeave) {
  RecordProperty("requirement", "FLEET-2");
  EXPECT_EQ(canaries_in(facts_of(session_with_canaries(), {}).ShortDebugString()), kSent);
}

TEST(FactsOf, LabelsAllowed_LabelAndNotesLeaveToo) {
  std::set<std::string> expected = kSent;
  expected.insert({"canary-label", "canary-notes"});
  EXPECT_EQ(canaries_in(facts_of(session_with_canaries(), {.labels = true}).ShortDebugString()), expected);
}

TEST(FactsOf, FieldAllowed_OnlyThisFieldLeaves) {
  const auto facts = facts_of(session_with_canaries(), {.fields = {"weight_kg", "height_cm"}});
  EXPECT_THAT(facts.fields(), UnorderedElementsAre(testing::Pair("weight_kg", "canary-weight")));
  EXPECT_FALSE(facts.has_label());
}

TEST(FactsOf, Session_KeepsItsNumbersAndChecksums) {
  v1::SessionRecord session;
  session.set_session_id("s-1");
  session.set_started_utc_ns(5);
  session.set_planned_trials(3);
  session.set_is_deleted(true);
  auto& part = *session.add_parts();
  part.set_part(2);
  part.set_state(v1::PART_STATE_RECOVERED);
  part.set_sha256(std::string(64, 'a'));
  part.set_bytes(100);
  part.set_scans(7);
  part.set_duration_s(1.5);
  part.set_valid_trials(1);
  part.set_is_loss_unknown(true);
  part.set_rig("plate");
  part.set_leading_part(1);
  for (const int lost : {3, 4}) part.add_losses()->set_lost_scans_total(lost);
  session.add_parts()->set_sha256("no checksum");
  auto& result = *session.add_results();
  result.set_name("MVELO");
  result.set_value(8.4);
  result.set_details("{}");
  const auto facts = facts_of(session, {});
  EXPECT_EQ(facts.started_utc_ns(), 5);
  EXPECT_FALSE(facts.has_ended_utc_ns());
  EXPECT_EQ(facts.planned_trials(), 3U);
  EXPECT_TRUE(facts.is_deleted());
  EXPECT_EQ(facts.revision(), 0U);
  ASSERT_EQ(facts.parts_size(), 2);
  EXPECT_EQ(facts.parts(0).part(), 2U);
  EXPECT_EQ(facts.parts(0).state(), v1::PART_STATE_RECOVERED);
  EXPECT_EQ(hex_of(facts.parts(0).recorded_sha256()), std::string(64, 'a'));
  EXPECT_THAT(facts.parts(0).sha256(), IsEmpty());
  EXPECT_EQ(facts.parts(0).bytes(), 100U);
  EXPECT_EQ(facts.parts(0).scans(), 7U);
  EXPECT_EQ(facts.parts(0).duration_s(), 1.5);
  EXPECT_EQ(facts.parts(0).lost_scans(), 7U);
  EXPECT_EQ(facts.parts(0).valid_trials(), 1U);
  EXPECT_TRUE(facts.parts(0).is_loss_unknown());
  EXPECT_EQ(facts.parts(0).rig(), "plate");
  EXPECT_EQ(facts.parts(0).leading_part(), 1U);
  EXPECT_THAT(facts.parts(1).recorded_sha256(), IsEmpty());
  ASSERT_EQ(facts.results_size(), 1);
  EXPECT_EQ(facts.results(0).value(), 8.4);
}

}  // namespace
}  // namespace dts::fleet::wire
