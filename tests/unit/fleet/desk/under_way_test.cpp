// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/under_way.h"

#include <gtest/gtest.h>

namespace dts::fleet::desk {
namespace {

TEST(UnderWayTest, MessagesAreLimited) {
  UnderWay under_way;
  for (std::size_t count = 0; count < UnderWay::kMostMessages; ++count) ASSERT_TRUE(under_way.add(1)) << count;
  EXPECT_FALSE(under_way.add(1));
  under_way.remove(1);
  EXPECT_TRUE(under_way.add(1));
}

TEST(UnderWayTest, BytesAreLimited) {
  UnderWay under_way;
  EXPECT_FALSE(under_way.add(UnderWay::kMostBytes + 1));
  ASSERT_TRUE(under_way.add(UnderWay::kMostBytes - 10));
  EXPECT_FALSE(under_way.add(11));
  EXPECT_TRUE(under_way.add(10));
  EXPECT_FALSE(under_way.add(1));
  under_way.remove(10);
  EXPECT_TRUE(under_way.add(1));
}

}  // namespace
}  // namespace dts::fleet::desk
