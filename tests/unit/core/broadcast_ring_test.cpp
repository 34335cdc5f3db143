// SPDX-License-Identifier: Apache-2.0
#include "core/broadcast_ring.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace dts::core {
namespace {

TEST(BroadcastRing, Elements_AreReadInAnyOrderUntilTheyAreOverwritten) {
  BroadcastRing<> ring(4, 2);
  ASSERT_EQ(ring.capacity(), 4U);
  std::array<std::uint64_t, 2> out{};
  for (std::uint64_t element = 0; element < 6; ++element) ring.write(std::array{element, 10 * element});
  EXPECT_EQ(ring.written(), 6U);
  for (const std::uint64_t element : {5U, 2U, 3U, 4U}) {
    ASSERT_EQ(ring.read(element, out), 2U) << element;
    EXPECT_EQ(out, (std::array{element, 10 * element}));
  }
  for (const std::uint64_t element : {0U, 1U}) EXPECT_FALSE(ring.read(element, out)) << element;
}

TEST(BroadcastRing, Sizes_AreThoseOfTheElements_AndOfTheSmallerBuffer) {
  BroadcastRing<> ring(4, 3);
  std::array<std::uint64_t, 3> out{};
  ring.write({});
  ring.write(std::array<std::uint64_t, 1>{7});
  ring.write(std::array<std::uint64_t, 5>{1, 2, 3, 4, 5});
  EXPECT_EQ(ring.read(0, out), 0U);
  EXPECT_EQ(ring.read(1, out), 1U);
  EXPECT_EQ(out[0], 7U);
  EXPECT_EQ(ring.read(2, out), 3U) << "words beyond the slot are ignored";
  EXPECT_EQ(out, (std::array<std::uint64_t, 3>{1, 2, 3}));
  EXPECT_EQ(ring.read(2, std::span(out).first(2)), 2U);
}

TEST(BroadcastRing, ReadersThatAreLate_NeverSeeATornElement_AndTheOthersSeeAll) {
  constexpr std::uint64_t kElements = 200'000;
  constexpr std::size_t kWords = 5;
  BroadcastRing<> ring(8, kWords);
  std::atomic<bool> is_torn = false;
  std::atomic<std::uint64_t> seen = 0;
  const auto follow = [&] {
    std::array<std::uint64_t, kWords> out{};
    for (std::uint64_t next = 0; next < kElements;) {
      const std::uint64_t written = ring.written();
      if (next == written) {
        std::this_thread::yield();
      } else if (const auto size = ring.read(next, out)) {
        is_torn = is_torn || *size != kWords || out != std::array{next, next, next, next, next};
        seen.fetch_add(1);
        ++next;
      } else {
        next = ring.written() - 1;
      }
    }
  };
  {
    const std::jthread first(follow);
    const std::jthread second(follow);
    for (std::uint64_t element = 0; element < kElements; ++element) {
      ring.write(std::array{element, element, element, element, element});
      if (element % 64 == 0) std::this_thread::yield();
    }
  }
  EXPECT_FALSE(is_torn);
  EXPECT_GE(seen, 2U) << "each has seen at least the last one";
}

}  // namespace
}  // namespace dts::core
