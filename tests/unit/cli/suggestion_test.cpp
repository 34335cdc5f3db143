// SPDX-License-Identifier: Apache-2.0
#include "cli/suggestion.h"

#include <gtest/gtest.h>

namespace dts::cli {
namespace {

TEST(Nearest, Word_IsFoundOnlyWhenNear) {
  const std::vector<std::string> words{"status", "session", "watch"};

  EXPECT_EQ(nearest("statsu", words), "status");
  EXPECT_EQ(nearest("wach", words), "watch");
  EXPECT_EQ(nearest("watchdog", words), "");
  EXPECT_EQ(nearest("x", words), "");
  EXPECT_EQ(nearest("", words), "");
  EXPECT_EQ(nearest("status", {}), "");
  EXPECT_EQ(nearest(std::string(100'000, 's'), words), "");
}

}  // namespace
}  // namespace dts::cli
