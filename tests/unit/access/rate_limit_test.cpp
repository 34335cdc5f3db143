// SPDX-License-Identifier: Apache-2.0
#include "access/rate_limit.h"

#include <gtest/gtest.h>

#include "key_fixture.h"

namespace dts::access {
namespace {

int taken(RateLimit& limit, const std::string& name, std::int64_t now_ns) {
  int count = 0;
  while (limit.take(name, now_ns)) ++count;
  return count;
}

TEST(RateLimit, ABurst_ThenTheRate) {
  RateLimit limit(10.0, 25.0);

  EXPECT_EQ(taken(limit, "a", 0), 25);
  EXPECT_EQ(taken(limit, "a", kSecondNs), 10);
  EXPECT_EQ(taken(limit, "a", kSecondNs + kSecondNs / 2), 5);
  EXPECT_EQ(taken(limit, "a", 1000 * kSecondNs), 25) << "a rest earns no more than a burst";
}

TEST(RateLimit, AClockThatStandsOrGoesBack_GivesNothing) {
  RateLimit limit(10.0, 1.0);
  ASSERT_TRUE(limit.take("a", 5 * kSecondNs));

  EXPECT_FALSE(limit.take("a", 5 * kSecondNs));
  EXPECT_FALSE(limit.take("a", 0));
}

TEST(RateLimit, ManyNames_ThoseThatRestedAreForgotten_TheOthersNot) {
  RateLimit limit(0.001, 1.0);
  ASSERT_TRUE(limit.take("busy", 0));
  for (int name = 0; name < 5000; ++name) static_cast<void>(limit.take(std::to_string(name), kSecondNs));

  EXPECT_FALSE(limit.take("busy", kSecondNs));
}

}  // namespace
}  // namespace dts::access
