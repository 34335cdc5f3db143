// SPDX-License-Identifier: Apache-2.0
#include "lsl/session_order.h"

#include <gtest/gtest.h>

namespace dts::lsl {
namespace {

v1::SessionChange change(const std::string& id, v1::SessionState state) {
  v1::SessionChange made;
  made.set_session_id(id);
  made.set_state(state);
  return made;
}

TEST(SessionOrder, FollowsTheSessionThatStartedFirst) {
  SessionOrder order;
  EXPECT_EQ(order.first(), "");
  order.take("floor", change("a", v1::SESSION_STATE_STARTING));
  order.take("chair", change("b", v1::SESSION_STATE_RUNNING));
  for (const auto state : {v1::SESSION_STATE_SETTLING, v1::SESSION_STATE_RUNNING, v1::SESSION_STATE_STOPPING}) {
    order.take("floor", change("a", state));
    EXPECT_EQ(order.first(), "a");
  }
  order.take("floor", change("a", v1::SESSION_STATE_IDLE));
  EXPECT_EQ(order.first(), "b");
  order.take("chair", change("b", v1::SESSION_STATE_FAILED));
  EXPECT_EQ(order.first(), "");
}

TEST(SessionOrder, SessionOverTwoRigs_EndsWithTheLastOfThem) {
  SessionOrder order;
  order.take("floor", change("a", v1::SESSION_STATE_RUNNING));
  order.take("plate", change("a", v1::SESSION_STATE_RUNNING));
  order.take("floor", change("a", v1::SESSION_STATE_IDLE));
  EXPECT_EQ(order.first(), "a");
  order.take("plate", change("a", v1::SESSION_STATE_IDLE));
  EXPECT_EQ(order.first(), "");
}

TEST(SessionOrder, RigsThatAreNotWanted_DoNotCount) {
  SessionOrder order({"chair"});
  order.take("floor", change("a", v1::SESSION_STATE_RUNNING));
  EXPECT_EQ(order.first(), "");
  order.take("chair", change("b", v1::SESSION_STATE_RUNNING));
  EXPECT_EQ(order.first(), "b");
}

TEST(SessionOrder, NextSessionOfARig_ReplacesAnEarlierOneWhoseEndWasMissed) {
  SessionOrder order;
  order.take("floor", change("a", v1::SESSION_STATE_RUNNING));
  order.take("floor", change("b", v1::SESSION_STATE_STARTING));
  EXPECT_EQ(order.first(), "b");
  order.clear();
  EXPECT_EQ(order.first(), "");
}

}  // namespace
}  // namespace dts::lsl
