// SPDX-License-Identifier: Apache-2.0
#include "session/session.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/clock.h"

namespace dts::session {
namespace {

using core::kNanosecondsPerSecond;

std::vector<SessionState> states(std::vector<SessionView> changes) {
  std::vector<SessionState> entered;
  for (const SessionView& change : changes) entered.push_back(change.state);
  return entered;
}

TEST(Session, FirstScanAfterStart_RunsAtOnceWithoutSettling) {
  Session session("floor");
  ASSERT_TRUE(session.start("id", {}, 0));

  session.tick(1 * kNanosecondsPerSecond, 100);
  session.tick(2 * kNanosecondsPerSecond, 102);

  EXPECT_EQ(states(session.take_changes()), (std::vector{SessionState::Starting, SessionState::Settling, SessionState::Running}));
}

TEST(Session, SettleTime_RunsOnlyAfterIt) {
  Session session("floor");
  ASSERT_TRUE(session.start("id", {.settle_s = 5.0}, 0));
  session.tick(0, 0);

  session.tick(1 * kNanosecondsPerSecond, 1);
  EXPECT_EQ(session.view(1 * kNanosecondsPerSecond).state, SessionState::Settling);
  session.tick(6 * kNanosecondsPerSecond - 1, 2);
  EXPECT_EQ(session.view(6 * kNanosecondsPerSecond).state, SessionState::Settling);
  session.tick(6 * kNanosecondsPerSecond, 3);
  EXPECT_EQ(session.view(6 * kNanosecondsPerSecond).state, SessionState::Running);
}

TEST(Session, DurationOver_StopsByItselfAndKeepsElapsed) {
  Session session("floor");
  ASSERT_TRUE(session.start("id", {.duration_s = 20.0}, 0));
  session.tick(0, 0);
  session.tick(1 * kNanosecondsPerSecond, 1);

  session.tick(21 * kNanosecondsPerSecond, 2);
  EXPECT_EQ(session.view(21 * kNanosecondsPerSecond).state, SessionState::Stopping);
  session.closed(22 * kNanosecondsPerSecond);

  EXPECT_EQ(session.view(30 * kNanosecondsPerSecond).state, SessionState::Idle);
  EXPECT_DOUBLE_EQ(session.view(30 * kNanosecondsPerSecond).elapsed_s, 20.0);
}

TEST(Session, NoScanForTenSeconds_FailsAndCanBeStartedAgain) {
  Session session("floor");
  ASSERT_TRUE(session.start("id", {}, 0));

  session.tick(1 * kNanosecondsPerSecond, 7);
  session.tick(11 * kNanosecondsPerSecond, 7);
  EXPECT_EQ(session.view(11 * kNanosecondsPerSecond).state, SessionState::Stopping);
  session.closed(11 * kNanosecondsPerSecond);

  EXPECT_EQ(session.view(11 * kNanosecondsPerSecond).state, SessionState::Failed);
  EXPECT_FALSE(session.view(11 * kNanosecondsPerSecond).message.empty());
  EXPECT_TRUE(session.start("again", {}, 12 * kNanosecondsPerSecond));
}

TEST(Session, StartTwice_IsRefusedAndTheFirstGoesOn) {
  Session session("floor");
  ASSERT_TRUE(session.start("first", {}, 0));

  const auto second = session.start("second", {}, 1);

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(session.view(1).id, "first");
}

TEST(Session, StopWhileTheRecordingIsClosed_IsRefused) {
  Session session("floor");
  ASSERT_TRUE(session.start("id", {}, 0));
  ASSERT_TRUE(session.stop(1));

  const auto again = session.stop(2);

  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, core::ErrorCode::WrongState);
  EXPECT_FALSE(session.start("another", {}, 3));
}

TEST(Session, Failure_ShowsOnlyWhenEverythingIsClosed) {
  Session session("floor");
  ASSERT_TRUE(session.start("id", {}, 0));

  session.fail(1, "disk full");
  EXPECT_EQ(session.view(1).state, SessionState::Stopping);
  session.closed(2);

  EXPECT_EQ(session.view(2).state, SessionState::Failed);
  EXPECT_EQ(session.view(2).message, "disk full");
}

TEST(Session, StopWhenIdle_IsRefused) {
  Session session("floor");

  const auto stopped = session.stop(0);

  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, core::ErrorCode::WrongState);
}

TEST(SessionRequest, SenselessFields_AreRefused) {
  EXPECT_TRUE(check({}));
  EXPECT_TRUE(check({.subject = "P-017_b.2", .label = "eyes closed", .duration_s = 25.0, .settle_s = 5.0}));
  EXPECT_FALSE(check({.subject = "Jane Doe"}));
  EXPECT_FALSE(check({.subject = std::string(65, 'a')}));
  EXPECT_FALSE(check({.label = std::string(201, 'a')}));
  EXPECT_FALSE(check({.duration_s = -1.0}));
  EXPECT_FALSE(check({.duration_s = std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_FALSE(check({.duration_s = 1e9}));
  EXPECT_FALSE(check({.settle_s = std::numeric_limits<double>::infinity()}));
}

}  // namespace
}  // namespace dts::session
