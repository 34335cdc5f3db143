// SPDX-License-Identifier: Apache-2.0
#include "fleet/link/turns.h"

#include <gtest/gtest.h>

namespace dts::fleet::link {
namespace {

using namespace std::chrono_literals;

TEST(Turns, TryThatTakesLong_IsNoSuccess) {
  Turns turns(2);
  Turns::Time now{};
  EXPECT_EQ(turns.server(), 0U);
  EXPECT_EQ(turns.ended(now += 1min), 0U);
  EXPECT_EQ(turns.server(), 1U);
  EXPECT_EQ(turns.ended(now += 1min), 0U);
  EXPECT_EQ(turns.server(), 0U);
  EXPECT_EQ(turns.ended(now += 1min), 1U);
  EXPECT_EQ(turns.server(), 1U);
}

TEST(Turns, OnlyAConnectionThatLasts_EndsTheLongPauses) {
  Turns turns(2);
  Turns::Time now{};
  for (int tries = 0; tries < 5; ++tries) static_cast<void>(turns.ended(now));
  turns.connected(now += 1min);  // after a try that took long
  EXPECT_EQ(turns.ended(now += 1s), 2U);
  turns.connected(now += 1s);
  EXPECT_EQ(turns.ended(now += 21s), 0U);
  EXPECT_EQ(turns.ended(now += 1min), 0U) << "the connection before is forgotten";
  EXPECT_EQ(turns.ended(now), 1U);
}

}  // namespace
}  // namespace dts::fleet::link
