// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/least_lead.h"

#include <gtest/gtest.h>

namespace dts::fleet::desk {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(LeastLead, TheMessageThatWasUnderWayShortest_Counts) {
  LeastLead lead;
  EXPECT_FALSE(lead.ns());
  lead.add(100, 70);   // 30 ahead, less the way
  lead.add(200, 165);  // 35
  lead.add(300, 280);  // 20: it was under way longer

  EXPECT_EQ(lead.ns(), 35);
}

TEST(LeastLead, ForgetsWhatIsOlderThanAMinute) {
  LeastLead lead;
  lead.add(35, 0);
  lead.add(31 * kSecond + 30, 31 * kSecond);
  EXPECT_EQ(lead.ns(), 35);
  lead.add(62 * kSecond + 20, 62 * kSecond);
  EXPECT_EQ(lead.ns(), 30);
  lead.add(200 * kSecond - 5, 200 * kSecond);
  EXPECT_EQ(lead.ns(), -5);
}

}  // namespace
}  // namespace dts::fleet::desk
