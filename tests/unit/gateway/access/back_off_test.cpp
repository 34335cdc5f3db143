// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/back_off.h"

#include <gtest/gtest.h>

namespace dts::gateway {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

class BackOffTest : public ::testing::Test {
 protected:
  void fail(const std::string& key, unsigned times = 1) {
    for (unsigned count = 0; count < times; ++count) back_off_.add_failure(key, now_);
  }
  [[nodiscard]] seconds wait(const std::string& key) const { return back_off_.wait(key, now_); }

  BackOff back_off_{seconds{30}, 5};
  BackOff::Time now_{hours{1000}};
};

TEST_F(BackOffTest, FiveFailuresAreFree) {
  fail("anna", 4);
  EXPECT_EQ(wait("anna"), seconds{0});
  fail("anna");
  EXPECT_EQ(wait("anna"), seconds{1});
  EXPECT_EQ(wait("bert"), seconds{0});
}

TEST_F(BackOffTest, EachFurtherOneDoublesTheWaitUpToTheLongest) {
  fail("anna", 5);
  for (const int expected : {2, 4, 8, 16, 30, 30}) {
    fail("anna");
    EXPECT_EQ(wait("anna"), seconds{expected});
  }
  fail("anna", 1000);
  EXPECT_EQ(wait("anna"), seconds{30});
}

TEST_F(BackOffTest, WaitPasses) {
  fail("anna", 6);

  now_ += std::chrono::milliseconds{1};
  EXPECT_EQ(wait("anna"), seconds{2}) << "rounded up: nobody comes too early";
  now_ += seconds{1};
  EXPECT_EQ(wait("anna"), seconds{1});
  now_ += seconds{1};
  EXPECT_EQ(wait("anna"), seconds{0});
}

TEST_F(BackOffTest, AnHourOrForgivenessForgets) {
  fail("anna", 9);
  fail("bert", 9);

  back_off_.forgive("anna");
  EXPECT_EQ(wait("anna"), seconds{0});
  now_ += hours{1};
  EXPECT_EQ(wait("bert"), seconds{0});
  fail("bert");
  EXPECT_EQ(wait("bert"), seconds{0}) << "the first again";
}

TEST_F(BackOffTest, OfTooManyKeysTheOneThatFailedLongestAgoGoes) {
  fail("first", 9);
  now_ += seconds{1};
  fail("second", 9);
  for (std::size_t count = 1; count < BackOff::kMostKeys; ++count) fail("k" + std::to_string(count));

  EXPECT_EQ(back_off_.size(), BackOff::kMostKeys);
  EXPECT_EQ(wait("first"), seconds{0});
  EXPECT_GT(wait("second"), seconds{0});
}

}  // namespace
}  // namespace dts::gateway
