// SPDX-License-Identifier: Apache-2.0
#include "core/utc_text.h"

#include <gtest/gtest.h>

namespace dts::core {
namespace {

TEST(UtcText, KnownInstants) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00.000000Z");
  EXPECT_EQ(utc_text(1'709'210'096'000'007'000), "2024-02-29T12:34:56.000007Z");
}

}  // namespace
}  // namespace dts::core
