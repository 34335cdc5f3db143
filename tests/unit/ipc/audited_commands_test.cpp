// SPDX-License-Identifier: Apache-2.0
// Which commands stand in the audit trail, and what of them.
#include <gmock/gmock.h>

#include "core/worker.h"
#include "ipc/audit_trail.h"
#include "session/recordings.h"
#include "unit/record/xdf_fixture.h"

namespace dts::ipc {
namespace {

class AuditedCommands : public testing::Test {
 protected:
  /// "who what target result" of what the request added to the trail; "": nothing.
  std::string entered(const v1::Request& request, const v1::Response& response = {}, const std::string& sender = "key:ina") {
    session::Supervisor supervisor(clock_, core::Log(), nullptr, {.recordings = *recordings_, .worker = worker_});
    enter_audit(supervisor, clock_, sender, request, response);
    const auto newest = recordings_->catalogue().audit(1).value();
    if (newest.empty() || std::exchange(last_, newest[0].number) == newest[0].number) return "";
    EXPECT_EQ(newest[0].utc_ns, clock_.now_ns() + clock_.utc_minus_monotonic_ns());
    return newest[0].who + " " + newest[0].what + " " + newest[0].target + " " + newest[0].result;
  }
  static v1::Response refused() {
    v1::Response response;
    response.mutable_error()->set_code(v1::ERROR_CODE_NOT_FOUND);
    return response;
  }

  /// Time and wall clock do not move.
  class StillClock final : public core::Clock {
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return 5; }
    void sleep_until_ns(std::int64_t) noexcept override {}
    [[nodiscard]] std::int64_t utc_minus_monotonic_ns() const noexcept override { return 1'000; }
  };
  record::xdf_test::Folder folder_;
  StillClock still_;
  core::Clock& clock_ = still_;
  core::Worker worker_{"analyse"};
  std::unique_ptr<session::Recordings> recordings_ = session::Recordings::open({.directory = folder_ / ""}, clock_, core::Log()).value();
  std::uint64_t last_ = 0;
};

TEST_F(AuditedCommands, WhatChangesSomething_AndLooksThatWereRefused) {
  v1::Request start;
  start.mutable_start_session()->set_rig("floor");
  v1::Response started;
  started.mutable_session()->set_session_id("s1");
  EXPECT_EQ(entered(start, started), "key:ina start_session s1 ok");
  start.set_on_behalf_of("anna");
  EXPECT_EQ(entered(start, refused(), "local"), "local:anna start_session  not_found");
  start.set_on_behalf_of("no name!");
  EXPECT_EQ(entered(start, started, "local"), "local start_session s1 ok");

  v1::Request status;
  status.mutable_status();
  EXPECT_EQ(entered(status), "");
  EXPECT_EQ(entered(status, refused()), "") << "everybody may look";
  v1::Request trail;
  trail.mutable_get_audit();
  EXPECT_EQ(entered(trail), "");
  EXPECT_EQ(entered(trail, refused()), "key:ina audit  not_found");
  EXPECT_EQ(entered({}), "");
}

}  // namespace
}  // namespace dts::ipc
