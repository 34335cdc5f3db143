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
  EXPECT_TRUE(is_damaged(status)) << "no instance id";
  status.set_instance_id(1);
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

/// Whether `message` is accepted with `most` elements that `add` adds, and refused with one more.
template <class Message, class Add>
bool ends_at(int most, Message message, Add add) {
  for (int count = 0; count < most; ++count) add(message);
  const bool is_accepted = check(message).has_value();
  add(message);
  return is_accepted && is_damaged(message);
}

v1::StatusSnapshot status() {
  v1::StatusSnapshot snapshot;
  snapshot.set_instance_id(7);
  snapshot.add_rigs()->mutable_rig()->set_name("floor");
  return snapshot;
}

v1::RigInfo rig() {
  v1::RigInfo info = status().rigs(0).rig();
  v1::StreamFormat& stream = *info.add_streams();
  stream.set_name("cop");
  stream.mutable_rate()->set_numerator(1);
  stream.mutable_rate()->set_denominator(1);
  stream.add_channels();
  return info;
}

TEST(WireCheck, ListsBeyondTheirLimits_AreRefused) {
  EXPECT_TRUE(ends_at(255, rig(), [](auto& info) { info.mutable_streams(0)->add_channels(); }));
  EXPECT_TRUE(ends_at(256, rig(), [](auto& info) { info.add_sensors(); }));
  EXPECT_TRUE(ends_at(63, rig(), [](auto& info) { *info.add_streams() = v1::StreamFormat(info.streams(0)); }));
  EXPECT_TRUE(ends_at(64, v1::ListRigsResponse(), [](auto& rigs) { *rigs.add_rigs() = rig(); }));
  EXPECT_TRUE(ends_at(63, status(), [](auto& snapshot) { *snapshot.add_rigs() = v1::RigStatus(snapshot.rigs(0)); }));
  EXPECT_TRUE(ends_at(1000, status(), [](auto& snapshot) { snapshot.add_notices(); }));
  EXPECT_TRUE(ends_at(1000, status(), [](auto& snapshot) { snapshot.mutable_rigs(0)->add_losses(); }));
  EXPECT_TRUE(ends_at(1000, status(), [](auto& snapshot) { snapshot.mutable_rigs(0)->mutable_latency()->add_buckets(); }));
  EXPECT_TRUE(ends_at(1000, v1::GetDevicesResponse(), [](auto& devices) { devices.add_devices(); }));
  EXPECT_TRUE(ends_at(1000, v1::GetDevicesResponse(), [](auto& devices) { devices.add_kinds(); }));
  EXPECT_TRUE(ends_at(1000, v1::TestDeviceResponse(), [](auto& test) { test.add_checks(); }));
  EXPECT_TRUE(ends_at(256, v1::TestDeviceResponse(), [](auto& test) { test.add_channels(); }));
  EXPECT_TRUE(ends_at(64, v1::MarkResponse(), [](auto& mark) { mark.add_marks(); }));
  EXPECT_TRUE(ends_at(256, v1::TareResponse(), [](auto& tare) { tare.add_baseline_mm(0.0); }));
  EXPECT_TRUE(ends_at(999, session(), [](auto& record) { record.add_parts()->set_state(v1::PART_STATE_COMPLETE); }));
  EXPECT_TRUE(ends_at(1000, session(), [](auto& record) { record.mutable_parts(0)->add_losses(); }));
  EXPECT_TRUE(ends_at(10'000, session(), [](auto& record) { record.add_trials(); }));
  EXPECT_TRUE(ends_at(10'000, v1::ListSessionsResponse(), [](auto& list) { list.add_sessions()->set_session_id("s"); }));
  EXPECT_TRUE(ends_at(10'000, v1::GetAuditResponse(), [](auto& audit) { audit.add_entries(); }));
  EXPECT_TRUE(ends_at(10'000, v1::ListKeysResponse(), [](auto& keys) { keys.add_keys(); }));
  v1::ListProtocolsResponse protocols;
  EXPECT_TRUE(ends_at(1000, protocols, [](auto& list) { *list.add_protocols() = protocol(); }));
  *protocols.add_protocols() = protocol();
  EXPECT_TRUE(ends_at(1000, protocols, [](auto& list) { list.mutable_protocols(0)->add_conditions(); }));
  EXPECT_TRUE(ends_at(999, protocols, [](auto& list) { list.mutable_protocols(0)->add_fields(); }));
  EXPECT_TRUE(ends_at(1000, protocols, [](auto& list) { list.mutable_protocols(0)->mutable_fields(0)->add_choices(); }));
}

TEST(WireCheck, NamesAndRatesOfARig_AreChecked) {
  const auto is_refused = [](const auto& change) {
    v1::ListRigsResponse rigs;
    *rigs.add_rigs() = rig();
    change(*rigs.mutable_rigs(0));
    return is_damaged(rigs);
  };
  EXPECT_FALSE(is_refused([](v1::RigInfo& info) { info.set_name(std::string(64, 'x')); }));
  for (const std::string& name : {std::string(), std::string(65, 'x'), std::string("a/b")}) {
    EXPECT_TRUE(is_refused([&](v1::RigInfo& info) { info.set_name(name); })) << name;
    EXPECT_TRUE(is_refused([&](v1::RigInfo& info) { info.mutable_streams(0)->set_name(name); })) << name;
  }
  EXPECT_TRUE(is_refused([](v1::RigInfo& info) { info.mutable_streams(0)->clear_channels(); }));
  constexpr std::int64_t kMost = 1'000'000'000'000;
  for (const auto& [numerator, denominator, is_good] :
       {std::tuple(kMost, kMost, true), {kMost + 1, kMost, false}, {kMost, kMost + 1, false}, {std::int64_t{0}, kMost, false}}) {
    EXPECT_NE(is_refused([&, n = numerator, d = denominator](v1::RigInfo& info) {
                info.mutable_streams(0)->mutable_rate()->set_numerator(n);
                info.mutable_streams(0)->mutable_rate()->set_denominator(d);
              }),
              is_good);
  }
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

  v1::StatusSnapshot snapshot = status();
  EXPECT_FALSE(is_damaged(snapshot));
  *snapshot.mutable_rigs(0)->mutable_session()->mutable_trial() = trial;
  EXPECT_TRUE(is_damaged(snapshot));
  snapshot = status();
  snapshot.mutable_disk()->set_recordable_s(-1.0);
  EXPECT_TRUE(is_damaged(snapshot));
  snapshot.mutable_disk()->set_recordable_s(0.0);
  snapshot.mutable_disk()->set_state(static_cast<v1::DiskState>(99));
  EXPECT_TRUE(is_damaged(snapshot));
}

}  // namespace
}  // namespace dts::client
