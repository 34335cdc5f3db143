// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/token_store.h"

#include <gtest/gtest.h>

#include <set>

namespace dts::gateway {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const Identity kAnna{.user = "anna", .role = v1::ROLE_OPERATOR};
const Identity kBert{.user = "bert", .role = v1::ROLE_VIEWER};

class TokenStoreTest : public ::testing::Test {
 protected:
  [[nodiscard]] bool is_known(const std::string& token) { return tokens_.use(token, now_).has_value(); }

  TokenStore tokens_{hours{12}, hours{2}};
  TokenStore::Time now_{hours{1000}};
};

TEST_F(TokenStoreTest, TokenTellsWhoseItIs) {
  const std::string token = tokens_.issue(kAnna, now_);

  const auto identity = tokens_.use(token, now_);

  ASSERT_TRUE(identity.has_value());
  EXPECT_EQ(identity->user, "anna");
  EXPECT_EQ(identity->role, v1::ROLE_OPERATOR);
  EXPECT_EQ(token.size(), 43U);
  EXPECT_EQ(token.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"), std::string::npos);
}

TEST_F(TokenStoreTest, WhatIsNoTokenIsNobodys) {
  const std::string token = tokens_.issue(kAnna, now_);

  EXPECT_FALSE(is_known(""));
  EXPECT_FALSE(is_known(token.substr(1)));
  EXPECT_FALSE(is_known(token + "A"));
  EXPECT_FALSE(is_known(std::string(100'000, 'A')));
}

TEST_F(TokenStoreTest, UnusedTokenEndsAfterItsIdleLife) {
  const std::string token = tokens_.issue(kAnna, now_);

  now_ += hours{2} - seconds{1};
  EXPECT_TRUE(is_known(token));
  now_ += hours{2} - seconds{1};
  EXPECT_TRUE(is_known(token)) << "each use begins it anew";
  now_ += hours{2};
  EXPECT_FALSE(is_known(token));
  EXPECT_EQ(tokens_.size(), 0U);
}

TEST_F(TokenStoreTest, UsedTokenEndsAfterItsLife) {
  const std::string token = tokens_.issue(kAnna, now_);
  const auto end = now_ + hours{12};

  for (; now_ < end; now_ += minutes{30}) EXPECT_TRUE(is_known(token));

  EXPECT_FALSE(is_known(token));
}

TEST_F(TokenStoreTest, RevokedTokensAreNobodys) {
  const std::string first = tokens_.issue(kAnna, now_);
  const std::string second = tokens_.issue(kAnna, now_);
  const std::string third = tokens_.issue(kAnna, now_);
  const std::string of_bert = tokens_.issue(kBert, now_);

  tokens_.revoke(first);
  EXPECT_FALSE(is_known(first));
  EXPECT_TRUE(is_known(second));
  tokens_.revoke_all_of("anna");

  EXPECT_FALSE(is_known(second));
  EXPECT_FALSE(is_known(third));
  EXPECT_TRUE(is_known(of_bert));
}

TEST_F(TokenStoreTest, OfTooManyOfOneUserTheLeastUsedGoes) {
  const std::string of_bert = tokens_.issue(kBert, now_);
  const std::string first = tokens_.issue(kAnna, now_ += seconds{1});
  const std::string second = tokens_.issue(kAnna, now_ += seconds{1});
  for (std::size_t count = 2; count < TokenStore::kMostOfOne; ++count) static_cast<void>(tokens_.issue(kAnna, now_ += seconds{1}));
  EXPECT_TRUE(is_known(first));

  const std::string last = tokens_.issue(kAnna, now_ += seconds{1});

  EXPECT_TRUE(is_known(first));
  EXPECT_FALSE(is_known(second));
  EXPECT_TRUE(is_known(last));
  EXPECT_TRUE(is_known(of_bert));
}

TEST_F(TokenStoreTest, OfTooManyAltogetherTheLeastUsedGoes) {
  std::set<std::string> all;
  const std::string first = tokens_.issue(kAnna, now_);
  for (std::size_t count = 0; count < TokenStore::kMost + 50; ++count) {
    all.insert(tokens_.issue({.user = "u" + std::to_string(count / 10), .role = v1::ROLE_VIEWER}, now_ += seconds{1}));
  }

  EXPECT_EQ(tokens_.size(), TokenStore::kMost);
  EXPECT_FALSE(is_known(first));
  EXPECT_EQ(all.size(), TokenStore::kMost + 50) << "no two are the same";
}

}  // namespace
}  // namespace dts::gateway
