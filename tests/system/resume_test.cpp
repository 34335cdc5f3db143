// SPDX-License-Identifier: Apache-2.0
// What a daemon does of itself after a crash in the middle of a session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;

class ResumeTest : public ::testing::Test {
 protected:
  [[nodiscard]] v1::SessionInfo session() const {
    const auto status = daemon_.control().status();
    return status ? status->rigs(0).session() : v1::SessionInfo();
  }
  [[nodiscard]] bool runs(const std::string& id) const {
    return session().session_id() == id && session().state() == v1::SESSION_STATE_RUNNING;
  }
  std::string start(double duration_s) {
    v1::StartSessionRequest request;
    request.set_rig("floor");
    request.set_protocol("free");
    request.set_duration_s(duration_s);
    const std::string id = daemon_.control().start_session(request).value().session_id();
    EXPECT_TRUE(eventually([&] { return runs(id); }));
    return id;
  }
  void crash() {
    daemon_.signal(SIGKILL);
    static_cast<void>(daemon_.wait());
    daemon_.restart();
  }

  DaemonProcess daemon_{{.acquire = {}, .stages = {}, .daemon = "[storage]\nresume_within_min = 10.0\n"}};
};

TEST_F(ResumeTest, AfterACrash_TheSessionGoesOnAsItsNextPart_WithWhatIsLeft) {
  RecordProperty("requirement", "SES-5");
  const std::string id = start(600.0);
  ASSERT_TRUE(eventually([&] { return session().elapsed_s() > 1.2; }));

  crash();

  ASSERT_TRUE(eventually([&] { return runs(id); }));
  EXPECT_EQ(daemon_.control().show_session(id)->parts_size(), 2);
  EXPECT_LT(session().duration_s(), 599.0);
  EXPECT_GT(session().duration_s(), 500.0);
  EXPECT_THAT(daemon_.log(), HasSubstr("was interrupted; dtsd resumed it"));
}

TEST_F(ResumeTest, WhatWasStoppedStaysStopped) {
  const std::string id = start(600.0);
  ASSERT_TRUE(daemon_.control().stop_session("floor"));

  crash();

  ASSERT_TRUE(eventually([&] { return daemon_.control().status()->rigs(0).scans_total() > 200; }));
  EXPECT_NE(session().session_id(), id);
}

}  // namespace
}  // namespace dts::test
