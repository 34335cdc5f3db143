// SPDX-License-Identifier: Apache-2.0
#include "core/token_bucket.h"

#include <gtest/gtest.h>

#include <chrono>

namespace dts::core {
namespace {

TEST(TokenBucket, ABurstIsFourSecondsWorthAndSilenceSavesUpNoMore) {
  TokenBucket bucket(10.0);
  const TokenBucket::Time start{std::chrono::seconds(1000)};

  int taken = 0;
  while (bucket.take(start)) ++taken;

  EXPECT_EQ(taken, 40);
  EXPECT_FALSE(bucket.take(start + std::chrono::milliseconds(50)));
  EXPECT_TRUE(bucket.take(start + std::chrono::milliseconds(150)));
  EXPECT_FALSE(bucket.take(start + std::chrono::milliseconds(150)));
  taken = 0;
  while (bucket.take(start + std::chrono::seconds(3600))) ++taken;
  EXPECT_EQ(taken, 40);
}

TEST(TokenBucket, AHeavyEvent_CountsAsSeveral_ButNeverAsMoreThanABurst) {
  TokenBucket bucket(1.0, 10.0);
  const TokenBucket::Time start{std::chrono::seconds(1000)};
  EXPECT_TRUE(bucket.take(start, 9.5));
  EXPECT_FALSE(bucket.has_one(start));
  EXPECT_TRUE(bucket.take(start, 0.5));
  EXPECT_FALSE(bucket.take(start + std::chrono::seconds(9), 100.0));
  EXPECT_TRUE(bucket.has_one(start + std::chrono::seconds(9)));
  EXPECT_TRUE(bucket.take(start + std::chrono::seconds(10), 100.0));
}

TEST(TokenBucket, WhatWasSpentTooMuch_IsWaitedFor) {
  TokenBucket bucket(0.5, 10.0);
  const TokenBucket::Time start{std::chrono::seconds(1000)};
  bucket.spend(start, 14.0);
  EXPECT_FALSE(bucket.has_one(start + std::chrono::seconds(9)));
  EXPECT_TRUE(bucket.has_one(start + std::chrono::seconds(10)));
}

TEST(TokenBucket, ATimeBeforeTheLast_GivesNothing) {
  TokenBucket bucket(1.0, 1.0);
  const TokenBucket::Time start{std::chrono::seconds(1000)};
  ASSERT_TRUE(bucket.take(start));
  EXPECT_FALSE(bucket.take(start - std::chrono::seconds(10)));
  EXPECT_FALSE(bucket.take(start)) << "the same ten seconds again";
  EXPECT_FALSE(bucket.is_full(start));
  EXPECT_TRUE(bucket.is_full(start + std::chrono::seconds(1)));
}

}  // namespace
}  // namespace dts::core
