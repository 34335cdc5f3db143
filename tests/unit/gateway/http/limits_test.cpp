// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "gateway/http/connection_limits.h"
#include "gateway/http/token_bucket.h"

namespace dts::gateway {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

boost::asio::ip::address address(const char* text) { return boost::asio::ip::make_address(text); }

TEST(ConnectionLimits, ANetworkOfAddressesCountsAsOneHost) {
  EXPECT_EQ(counted_as(address("2001:db8:1:2:3::4")), counted_as(address("2001:db8:1:2:ffff::1")));
  EXPECT_NE(counted_as(address("2001:db8:1:2::1")), counted_as(address("2001:db8:1:3::1")));
  EXPECT_EQ(counted_as(address("127.0.0.1")), counted_as(address("::1")));
  EXPECT_EQ(counted_as(address("127.9.9.9")), counted_as(address("::ffff:127.0.0.1")));
}

TEST(ConnectionLimits, AnAddressAsTextCountsAsTheAddress) {
  for (const char* text : {"192.0.2.7", "::ffff:192.0.2.7", "2001:db8:1:2::99", "127.0.0.1"}) {
    EXPECT_EQ(counted_as(std::string(text)), counted_as(address(text))) << text;
  }
  EXPECT_EQ(counted_as(std::string("::ffff:192.0.2.7")), "192.0.2.7");
  EXPECT_EQ(counted_as(std::string("nonsense")), "nonsense");
}

TEST(TokenBucket, ABurstIsFourSecondsWorthAndSilenceSavesUpNoMore) {
  TokenBucket bucket(10.0);
  const TokenBucket::Time start{seconds(1000)};

  int taken = 0;
  while (bucket.take(start)) ++taken;

  EXPECT_EQ(taken, 40);
  EXPECT_FALSE(bucket.take(start + milliseconds(50)));
  EXPECT_TRUE(bucket.take(start + milliseconds(150)));
  EXPECT_FALSE(bucket.take(start + milliseconds(150)));
  taken = 0;
  while (bucket.take(start + seconds(3600))) ++taken;
  EXPECT_EQ(taken, 40);
}

}  // namespace
}  // namespace dts::gateway
