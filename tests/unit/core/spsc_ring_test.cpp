// SPDX-License-Identifier: Apache-2.0
#include "core/spsc_ring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <vector>

#include "core/frame.h"

namespace dts::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<int> pop_all(SpscRing<int>& ring) {
  std::vector<int> popped(ring.capacity() + 1);
  popped.resize(ring.pop(popped));
  return popped;
}

std::vector<int> numbers(int first, int count) {
  std::vector<int> values(static_cast<std::size_t>(count));
  std::iota(values.begin(), values.end(), first);
  return values;
}

TEST(SpscRing, Capacity_IsTheNextPowerOfTwo) {
  EXPECT_EQ(SpscRing<int>(0).capacity(), 1U);
  EXPECT_EQ(SpscRing<int>(1).capacity(), 1U);
  EXPECT_EQ(SpscRing<int>(2).capacity(), 2U);
  EXPECT_EQ(SpscRing<int>(5).capacity(), 8U);
  EXPECT_EQ(SpscRing<int>(8).capacity(), 8U);
}

TEST(SpscRing, Constructed_IsEmptyAndHasDroppedNothing) {
  SpscRing<int> ring(4);
  int out = -1;

  EXPECT_EQ(ring.front(), nullptr);
  EXPECT_FALSE(ring.pop(out));
  EXPECT_EQ(out, -1);
  EXPECT_THAT(pop_all(ring), IsEmpty());
  EXPECT_EQ(ring.dropped(), 0U);
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

TEST(SpscRing, InPlace_HandsOverInOrder) {
  SpscRing<int> ring(4);
  for (const int value : {1, 2, 3}) {
    *ring.claim() = value;
    ring.commit();
  }

  for (const int value : {1, 2, 3}) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), value);
    ring.release();
  }
  EXPECT_EQ(ring.front(), nullptr);
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

TEST(SpscRing, Full_ClaimsNothingUntilASlotIsReleased) {
  SpscRing<int> ring(2);
  ring.push(1);
  ring.push(2);

  EXPECT_EQ(ring.claim(), nullptr);
  ring.release();
  EXPECT_NE(ring.claim(), nullptr);
}

TEST(SpscRing, FullSinglePush_DropsTheNewElementAndCounts) {
  SpscRing<int> ring(2);

  EXPECT_TRUE(ring.push(1));
  EXPECT_TRUE(ring.push(2));
  EXPECT_FALSE(ring.push(3));
  EXPECT_FALSE(ring.push(4));

  EXPECT_EQ(ring.dropped(), 2U);
  EXPECT_THAT(pop_all(ring), ElementsAre(1, 2));
}

TEST(SpscRing, BlockLargerThanTheRoom_IsTakenInPart) {
  SpscRing<int> ring(4);
  ring.push(1);

  EXPECT_EQ(ring.push(numbers(2, 6)), 3U);

  EXPECT_EQ(ring.dropped(), 3U);
  EXPECT_THAT(pop_all(ring), ElementsAre(1, 2, 3, 4));
}

TEST(SpscRing, BlockIntoFullRing_IsDroppedWhole) {
  SpscRing<int> ring(2);
  ring.push(numbers(1, 2));

  EXPECT_EQ(ring.push(numbers(3, 2)), 0U);

  EXPECT_EQ(ring.dropped(), 2U);
}

TEST(SpscRing, EmptyBlocks_ChangeNothing) {
  SpscRing<int> ring(2);
  ring.push(1);

  EXPECT_EQ(ring.push(std::span<const int>{}), 0U);
  EXPECT_EQ(ring.pop(std::span<int>{}), 0U);

  EXPECT_EQ(ring.dropped(), 0U);
  EXPECT_THAT(pop_all(ring), ElementsAre(1));
}

TEST(SpscRing, PopOfFewerThanThere_LeavesTheRest) {
  SpscRing<int> ring(8);
  ring.push(numbers(1, 5));
  std::array<int, 2> two{};

  EXPECT_EQ(ring.pop(std::span{two}), 2U);

  EXPECT_THAT(two, ElementsAre(1, 2));
  EXPECT_THAT(pop_all(ring), ElementsAre(3, 4, 5));
}

TEST(SpscRing, BlocksAcrossTheEnd_ArriveInOrder) {
  SpscRing<int> ring(8);
  for (int start = 0; start < 8; ++start) {  // the block begins at each slot once
    EXPECT_EQ(ring.push(numbers(100 * start, 7)), 7U);
    EXPECT_EQ(pop_all(ring), numbers(100 * start, 7));
    ring.push(-1);
    ring.push(-1);
    pop_all(ring);
  }
  EXPECT_EQ(ring.dropped(), 0U);
}

TEST(SpscRing, CapacityOne_Works) {
  SpscRing<int> ring(1);

  for (int value = 0; value < 5; ++value) {
    EXPECT_TRUE(ring.push(value));
    EXPECT_FALSE(ring.push(99));
    EXPECT_THAT(pop_all(ring), ElementsAre(value));
  }
  EXPECT_EQ(ring.dropped(), 5U);
}

TEST(SpscRing, CallsOfDifferentKinds_Mix) {
  SpscRing<int> ring(4);
  ring.push(1);
  *ring.claim() = 2;
  ring.commit();
  ring.push(numbers(3, 2));

  int first = 0;
  EXPECT_TRUE(ring.pop(first));
  EXPECT_EQ(first, 1);
  EXPECT_EQ(*ring.front(), 2);
  ring.release();
  EXPECT_THAT(pop_all(ring), ElementsAre(3, 4));
}

TEST(SpscRing, DropByHand_IsCounted) {
  SpscRing<int> ring(2);

  ring.drop();
  ring.drop(41);

  EXPECT_EQ(ring.dropped(), 42U);
}

}  // namespace
}  // namespace dts::core
