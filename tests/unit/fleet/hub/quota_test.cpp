// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/quota.h"

#include <gtest/gtest.h>

namespace dts::fleet::hub {
namespace {

using wire::Matter;

constexpr core::TokenBucket::Time kStart{std::chrono::hours(1)};

/// Returns how many messages of `bytes` bytes are allowed within `seconds`, of ten times as many that are sent.
int handled(MessageQuota& quota, const std::string& clinic, Matter matter, std::size_t bytes, int seconds, int sent_per_s) {
  int count = 0;
  for (int number = 0; number < seconds * sent_per_s; ++number) {
    const auto now = kStart + std::chrono::microseconds(std::int64_t{number} * 1'000'000 / sent_per_s);
    count += quota.take(clinic, matter, bytes, now) ? 1 : 0;
  }
  return count;
}

TEST(MessageQuota, ClinicThatCatchesUpTenThousandSessions_IsNotSlowedBelow50PerSecond) {
  MessageQuota quota(QuotaFigures{}.messages_per_s);
  // 12 kB: a session with 300 results.
  EXPECT_GE(handled(quota, "kent", Matter::Facts, 12'000, 200, 1000), 200 * 50);
  EXPECT_GE(handled(quota, "kent", Matter::Open, 100, 200, 1000), 200 * 50);
  EXPECT_GE(handled(quota, "kent", Matter::Commit, 40, 200, 1000), 200 * 50);
}

TEST(MessageQuota, ClinicThatFloods_GetsItsShare_AndOthersAndOtherMattersTheirs) {
  MessageQuota quota(100.0);
  EXPECT_LE(handled(quota, "kent", Matter::Facts, 100, 10, 10'000), 400 + 10 * 100);
  EXPECT_LE(handled(quota, "kent", Matter::Facts, 900'000, 10, 1'000), 30);
  EXPECT_LE(handled(quota, "kent", Matter::Beat, 100, 10, 1'000), 4 + 10);
  EXPECT_TRUE(quota.take("kent", Matter::Open, 100, kStart));
  EXPECT_TRUE(quota.take("leeds", Matter::Facts, 100, kStart));
  const auto slowed = quota.slowed();
  EXPECT_GT(slowed.at("kent"), 90'000U);
  EXPECT_EQ(slowed.at("leeds"), 0U);
}

TEST(MessageQuota, LargeMessage_IsAllowedAlsoWithASmallQuota) {
  MessageQuota quota(1.0);
  EXPECT_TRUE(quota.take("kent", Matter::Facts, 900'000, kStart));
  EXPECT_FALSE(quota.take("kent", Matter::Facts, 900'000, kStart + std::chrono::seconds(3)));
  EXPECT_TRUE(quota.take("kent", Matter::Facts, 900'000, kStart + std::chrono::seconds(4)));
}

TEST(MessageQuota, Chunks_AreNotSlowedAt400MBPerSecond) {
  MessageQuota quota(QuotaFigures{}.messages_per_s);
  EXPECT_EQ(handled(quota, "kent", Matter::Chunk, 256 * 1024, 10, 1600), 16'000);
}

}  // namespace
}  // namespace dts::fleet::hub
