// SPDX-License-Identifier: Apache-2.0
#include "core/spsc_ring.h"

#include <gtest/gtest.h>

#include "core/frame.h"

namespace dts::core {
namespace {

TEST(SpscRing, Capacity_IsTheNextPowerOfTwo) {
  EXPECT_EQ(SpscRing<int>(0).capacity(), 1U);
  EXPECT_EQ(SpscRing<int>(1).capacity(), 1U);
  EXPECT_EQ(SpscRing<int>(2).capacity(), 2U);
  EXPECT_EQ(SpscRing<int>(5).capacity(), 8U);
  EXPECT_EQ(SpscRing<int>(8).capacity(), 8U);
}

TEST(SpscRing, Slots_AreCopiesOfThePrototype) {
  SpscRing<Block> ring(2, Block(3, 16));

  for (int i = 0; i < 4; ++i) {
    Block* const slot = ring.claim();
    ASSERT_NE(slot, nullptr);
    EXPECT_EQ(slot->channel_count(), 3U);
    EXPECT_EQ(slot->capacity(), 16U);
    ring.commit();
    ring.release();
  }
}

TEST(SpscRing, ClaimedButNotCommitted_IsNotSeen) {
  SpscRing<int> ring(4);

  int* const slot = ring.claim();
  *slot = 1;

  EXPECT_EQ(ring.front(), nullptr);
  EXPECT_EQ(ring.claim(), slot);
}

TEST(SpscRing, SlotsInUse_KeepTheirAddress) {
  SpscRing<int> ring(2);
  int* const first = ring.claim();
  ring.commit();
  int* const second = ring.claim();
  ring.commit();

  EXPECT_EQ(ring.front(), first);
  ring.release();
  EXPECT_EQ(ring.claim(), first);
  EXPECT_EQ(ring.front(), second);
}

TEST(SpscRing, DropByHand_IsCounted) {
  SpscRing<int> ring(2);

  ring.drop();
  ring.drop(41);

  EXPECT_EQ(ring.dropped(), 42U);
}

}  // namespace
}  // namespace dts::core
