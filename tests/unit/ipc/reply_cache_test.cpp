// SPDX-License-Identifier: Apache-2.0
#include "ipc/reply_cache.h"

#include <gtest/gtest.h>

namespace dts::ipc {
namespace {

TEST(ReplyCache, UnknownId_IsNotFound) { EXPECT_EQ(ReplyCache(2).find("a"), nullptr); }

TEST(ReplyCache, Full_ForgetsTheOldestOnly) {
  ReplyCache cache(2);
  cache.store("a", {.request = "ask", .reply = "1"});
  cache.store("b", {.request = "ask", .reply = "2"});

  cache.store("c", {.request = "ask", .reply = "3"});

  EXPECT_EQ(cache.find("a"), nullptr);
  ASSERT_NE(cache.find("b"), nullptr);
  EXPECT_EQ(cache.find("c")->reply, "3");
}

TEST(ReplyCache, SameIdAgain_ReplacesWithoutForgettingOthers) {
  ReplyCache cache(2);
  cache.store("a", {.request = "ask", .reply = "1"});
  cache.store("b", {.request = "ask", .reply = "2"});

  cache.store("b", {.request = "ask", .reply = "changed"});

  EXPECT_NE(cache.find("a"), nullptr);
  EXPECT_EQ(cache.find("b")->reply, "changed");
}

}  // namespace
}  // namespace dts::ipc
