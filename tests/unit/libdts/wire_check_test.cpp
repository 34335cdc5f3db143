// SPDX-License-Identifier: Apache-2.0
#include "../clients/libdts/wire_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dts::client {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

v1::SessionRecord session() {
  v1::SessionRecord record;
  record.set_session_id("s1");
  record.add_parts()->set_state(v1::PART_STATE_COMPLETE);
  return record;
}

v1::ProtocolInfo protocol() {
  v1::ProtocolInfo info;
  info.set_name("free");
  info.add_fields()->set_maximum(1.0);
  return info;
}

template <class Message>
bool is_damaged(const Message& message) {
  const auto checked = check(message);
  return !checked && checked.error().code == ErrorCode::DataDamaged && !checked.error().what.empty();
}

TEST(WireCheck, ProperAnswers_AreAccepted) {
  EXPECT_TRUE(check(session()).has_value());
  v1::ListProtocolsResponse protocols;
  *protocols.add_protocols() = protocol();
  EXPECT_TRUE(check(protocols).has_value());
  EXPECT_TRUE(check(v1::ListSessionsResponse()).has_value());
  EXPECT_TRUE(check(v1::TrialStatus()).has_value());
  EXPECT_TRUE(check(v1::GetAuditResponse()).has_value());
  v1::StatusSnapshot status;
  status.set_instance_id(7);
  EXPECT_TRUE(check(status).has_value());
}

TEST(WireCheck, SessionWithoutIdOrWithImpossibleParts_IsRefused) {
  v1::SessionRecord record = session();
  record.clear_session_id();
  EXPECT_TRUE(is_damaged(record));
  for (const int state : {0, -1, 99}) {
    record = session();
    record.mutable_parts(0)->set_state(static_cast<v1::PartState>(state));
    EXPECT_TRUE(is_damaged(record)) << state;
  }
  for (const double value : {kNan, -1.0, std::numeric_limits<double>::infinity()}) {
    record = session();
    record.mutable_parts(0)->set_duration_s(value);
    EXPECT_TRUE(is_damaged(record)) << value;
    record = session();
    record.mutable_parts(0)->set_lost_s_at_most(value);
    EXPECT_TRUE(is_damaged(record)) << value;
  }
}

TEST(WireCheck, OneWrongSessionOfMany_RefusesTheList) {
  v1::ListSessionsResponse list;
  for (int count = 0; count < 3; ++count) *list.add_sessions() = session();
  EXPECT_TRUE(check(list).has_value());

  list.mutable_sessions(1)->clear_session_id();

  EXPECT_TRUE(is_damaged(list));
}

TEST(WireCheck, ListsBeyondTheirLimits_AreRefused) {
  v1::SessionRecord record = session();
  for (int part = 0; part < 1000; ++part) record.add_parts()->set_state(v1::PART_STATE_COMPLETE);
  EXPECT_TRUE(is_damaged(record));
  record = session();
  for (int trial = 0; trial < 10'001; ++trial) record.add_trials();
  EXPECT_TRUE(is_damaged(record));
  v1::GetAuditResponse audit;
  for (int entry = 0; entry < 10'001; ++entry) audit.add_entries();
  EXPECT_TRUE(is_damaged(audit));
  audit.mutable_entries()->RemoveLast();
  EXPECT_FALSE(is_damaged(audit));
}

TEST(WireCheck, ProtocolsWithImpossibleNumbers_AreRefused) {
  v1::ListProtocolsResponse protocols;
  v1::ProtocolInfo& info = *protocols.add_protocols();
  info = protocol();
  info.set_name("");
  EXPECT_TRUE(is_damaged(protocols));
  info = protocol();
  info.set_duration_s(kNan);
  EXPECT_TRUE(is_damaged(protocols));
  info = protocol();
  info.mutable_fields(0)->set_minimum(2.0);
  EXPECT_TRUE(is_damaged(protocols)) << "more than the maximum";
  info = protocol();
  info.mutable_fields(0)->set_maximum(kNan);
  EXPECT_TRUE(is_damaged(protocols));
}

TEST(WireCheck, TrialAndDisk_AreCheckedWhereverTheyStand) {
  v1::TrialStatus trial;
  trial.set_phase(static_cast<v1::TrialPhase>(99));
  EXPECT_TRUE(is_damaged(trial));
  v1::SessionInfo info;
  info.set_session_id("s1");
  EXPECT_FALSE(is_damaged(info));
  *info.mutable_trial() = trial;
  EXPECT_TRUE(is_damaged(info));
  trial.set_phase(v1::TRIAL_PHASE_READY);
  trial.set_remaining_s(kNan);
  EXPECT_TRUE(is_damaged(trial));

  v1::StatusSnapshot status;
  status.set_instance_id(7);
  EXPECT_FALSE(is_damaged(status));
  status.mutable_disk()->set_recordable_s(-1.0);
  EXPECT_TRUE(is_damaged(status));
  status.mutable_disk()->set_recordable_s(0.0);
  status.mutable_disk()->set_state(static_cast<v1::DiskState>(99));
  EXPECT_TRUE(is_damaged(status));
}

}  // namespace
}  // namespace dts::client
