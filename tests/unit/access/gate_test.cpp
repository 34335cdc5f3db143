// SPDX-License-Identifier: Apache-2.0
#include "access/gate.h"

#include <gtest/gtest.h>

#include <map>

#include "key_fixture.h"

namespace dts::access {
namespace {

/// Who may do what, written down a second time: a role changed in control.proto must be changed here too.
const std::map<std::string, v1::Role> kNeeded{
    {"status", v1::ROLE_VIEWER},
    {"list_rigs", v1::ROLE_VIEWER},
    {"start_session", v1::ROLE_OPERATOR},
    {"stop_session", v1::ROLE_OPERATOR},
    {"mark", v1::ROLE_OPERATOR},
    {"tare", v1::ROLE_OPERATOR},
    {"get_devices", v1::ROLE_VIEWER},
    {"test_device", v1::ROLE_ENGINEER},
    {"list_sessions", v1::ROLE_VIEWER},
    {"show_session", v1::ROLE_VIEWER},
    {"list_protocols", v1::ROLE_VIEWER},
    {"trial", v1::ROLE_OPERATOR},
    {"resume_session", v1::ROLE_OPERATOR},
    {"get_audit", v1::ROLE_ENGINEER},
    {"list_keys", v1::ROLE_ENGINEER},
    {"add_key", v1::ROLE_ENGINEER},
    {"revoke_key", v1::ROLE_ENGINEER},
    {"note_login", v1::ROLE_ENGINEER},
    {"correct_session", v1::ROLE_OPERATOR},
    {"delete_session", v1::ROLE_OPERATOR},
    {"list_subjects", v1::ROLE_OPERATOR},
    {"show_subject", v1::ROLE_OPERATOR},
    {"edit_subject", v1::ROLE_OPERATOR},
    {"erase_subject", v1::ROLE_ENGINEER},
};

v1::Request request_of(const google::protobuf::FieldDescriptor& command) {
  v1::Request request;
  request.GetReflection()->MutableMessage(&request, &command);
  return request;
}

class GateTest : public KeyFixture {
 protected:
  void SetUp() override {
    KeyFixture::SetUp();
    for (const ClientKey& key : {eve_, otto_, ina_}) ASSERT_TRUE(store_->add(key));
  }
  [[nodiscard]] Peer peer(const ClientKey& key) const { return gate_.remote(key.public_key); }

  const ClientKey eve_ = key_for("eve", v1::ROLE_VIEWER);
  const ClientKey otto_ = key_for("otto", v1::ROLE_OPERATOR);
  const ClientKey ina_ = key_for("ina", v1::ROLE_ENGINEER);
  const ClientKey nobody_ = key_for("nobody", v1::ROLE_UNSPECIFIED);
  Gate gate_{store_.get()};
};

TEST_F(GateTest, EveryCommandAndEveryRole) {
  RecordProperty("requirement", "SEC-1");
  const auto* commands = v1::Request::descriptor()->FindOneofByName("command");
  ASSERT_EQ(static_cast<std::size_t>(commands->field_count()), kNeeded.size());
  for (int index = 0; index < commands->field_count(); ++index) {
    const auto& command = *commands->field(index);
    const v1::Role needed = kNeeded.at(command.name());
    EXPECT_TRUE(Gate::check(Gate::local(), request_of(command))) << command.name() << " over a local socket";
    for (const ClientKey& key : {eve_, otto_, ina_, nobody_}) {
      const auto allowed = Gate::check(peer(key), request_of(command));
      const bool is_for_this_machine = command.name() == "note_login";
      EXPECT_EQ(allowed.has_value(), key.role >= needed && !is_for_this_machine) << command.name() << " by " << key.name;
      if (!allowed) {
        EXPECT_EQ(allowed.error().code, core::ErrorCode::NotAllowed);
      }
    }
  }
}

TEST_F(GateTest, ARevokedKey_LosesItsRightsAtOnce_AlsoWhenAnotherHasItsName) {
  v1::Request mark;
  mark.mutable_mark();
  ASSERT_TRUE(Gate::check(peer(otto_), mark));
  ASSERT_TRUE(store_->revoke("otto"));
  ASSERT_TRUE(store_->add(key_for("otto", v1::ROLE_ENGINEER)));

  EXPECT_EQ(core::to_string(Gate::check(peer(otto_), mark).error()),
            "this command needs the role operator; revoked key has none (ask an engineer for a key with this role: dtsctl key new NAME "
            "--role operator)");
}

TEST_F(GateTest, FailuresAreNotedAFewTimesOnly) {
  int noted = 0;
  for (int turn = 0; turn < 100; ++turn) noted += gate_.is_worth_a_note(peer(eve_), 0) ? 1 : 0;

  EXPECT_EQ(noted, 20);
  EXPECT_FALSE(gate_.is_worth_a_note(peer(eve_), 9 * kSecondNs));
  EXPECT_TRUE(gate_.is_worth_a_note(peer(eve_), 11 * kSecondNs));
  EXPECT_FALSE(gate_.is_worth_a_note(peer(eve_), 11 * kSecondNs));
}

TEST_F(GateTest, WhoInTheAuditTrail) {
  EXPECT_EQ(Gate::local().who, "local");
  EXPECT_EQ(peer(eve_).who, "key:eve");
  EXPECT_EQ(peer(nobody_).who, "revoked key");
  EXPECT_EQ(gate_.remote("").role, v1::ROLE_UNSPECIFIED);
  EXPECT_EQ(Peer{}.role, v1::ROLE_UNSPECIFIED);
}

}  // namespace
}  // namespace dts::access
