// SPDX-License-Identifier: Apache-2.0
#include "relay/message_limit.h"

#include <gtest/gtest.h>

namespace dts::relay {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

TEST(MessageLimit, TooManyCommands_AreRefusedForThatKeyOnly) {
  MessageLimit limit;
  int admitted = 0;
  int answered = 0;
  for (int turn = 0; turn < 1000; ++turn) {
    const bool is_admitted = limit.admit("key:eve", 0).has_value();
    admitted += is_admitted ? 1 : 0;
    answered += is_admitted || limit.is_worth_an_answer("key:eve", 0) ? 1 : 0;
  }

  EXPECT_EQ(admitted, 100);
  EXPECT_EQ(answered, 200) << "beyond that they are not worth an answer";
  EXPECT_EQ(core::to_string(limit.admit("key:eve", 0).error()),
            "more than 50 commands per second from key:eve (subscribe to dtsd/status instead of repeating the command)");
  EXPECT_TRUE(limit.admit("key:otto", 0));
  admitted = 0;
  while (limit.admit("key:eve", kSecondNs)) ++admitted;
  EXPECT_EQ(admitted, 50) << "a second later";
}

}  // namespace
}  // namespace dts::relay
