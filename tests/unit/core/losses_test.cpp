// SPDX-License-Identifier: Apache-2.0
#include "core/losses.h"

#include <gtest/gtest.h>

#include <limits>

namespace dts::core {
namespace {

TEST(Losses, AddUpByReason) {
  Losses losses;
  losses.add(GapReason::RingFull, {.gaps = 1, .scans = 10'560});
  losses.add(GapReason::Silence, {.gaps = 1, .scans = 40});
  losses.add(GapReason::Silence, {.gaps = 1, .scans = 2});

  EXPECT_EQ(losses.of(GapReason::Silence), (LossCount{.gaps = 2, .scans = 42}));
  EXPECT_EQ(losses.of(GapReason::Overrun), LossCount{});
  EXPECT_EQ(losses.total(), (LossCount{.gaps = 3, .scans = 10'602}));
  EXPECT_EQ(to_text(losses), "10602 scans lost in 3 gaps: silence 2, ring_full 1");
}

TEST(Losses, Text_IsEmptyWithoutAGapAndKnowsOneFromMany) {
  Losses losses;
  EXPECT_EQ(to_text(losses), "");
  losses.add(GapReason::None, {.gaps = 1, .scans = 1});
  EXPECT_EQ(to_text(losses), "1 scan lost in 1 gap: unknown 1");
}

TEST(Losses, CountsThatDoNotFit_StayAtTheLargest) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  Losses losses;
  losses.add(GapReason::Stall, {.gaps = 1, .scans = kMost});
  losses.add(GapReason::Stall, {.gaps = 1, .scans = 2});
  losses.add(GapReason::Silence, {.gaps = 1, .scans = 2});
  EXPECT_EQ(losses.of(GapReason::Stall).scans, kMost);
  EXPECT_EQ(losses.total(), (LossCount{.gaps = 3, .scans = kMost}));
}

}  // namespace
}  // namespace dts::core
