// SPDX-License-Identifier: Apache-2.0
// Two threads at one ring, in all combinations of calls: every element arrives in order or is counted as dropped. Small
// rings, so that they run full, run empty and wrap all the time. Under the thread sanitizer this also shows data races;
// what it cannot show (orders the processor at hand does not use) is left to tests/model_check.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "core/spsc_ring.h"

namespace dts::core {
namespace {

constexpr std::uint64_t kElements = 20'000;
constexpr std::uint64_t kFewestElements = 500;  // the rings of 64 have wrapped several times
constexpr std::chrono::seconds kLongest{1};
constexpr std::size_t kBlock = 7;  // no divisor of any capacity

/// Larger than a machine word, so that a torn copy would show.
struct Element {
  std::uint64_t value = 0;
  std::array<std::uint64_t, 9> copies{};

  static Element of(std::uint64_t value) {
    Element element{.value = value};
    element.copies.fill(value);
    return element;
  }
  [[nodiscard]] bool is_whole() const {
    return std::ranges::all_of(copies, [this](std::uint64_t copy) { return copy == value; });
  }
};
using Ring = SpscRing<Element>;

/// Sends `first` to `first + count - 1` once; returns how many were taken.
using Push = std::size_t (*)(Ring& ring, std::uint64_t first, std::size_t count);

std::size_t push_single(Ring& ring, std::uint64_t first, std::size_t count) {
  std::size_t taken = 0;
  while (taken < count && ring.push(Element::of(first + taken))) ++taken;
  if (taken + 1 < count) ring.drop(count - taken - 1);  // the first that found no room is counted already
  return taken;
}

std::size_t push_in_place(Ring& ring, std::uint64_t first, std::size_t count) {
  for (std::size_t taken = 0; taken < count; ++taken) {
    Element* const slot = ring.claim();
    if (slot == nullptr) {
      ring.drop(count - taken);
      return taken;
    }
    *slot = Element::of(first + taken);
    ring.commit();
  }
  return count;
}

std::size_t push_block(Ring& ring, std::uint64_t first, std::size_t count) {
  std::array<Element, kBlock> block;
  for (std::size_t i = 0; i < count; ++i) block[i] = Element::of(first + i);
  return ring.push(std::span<const Element>{block}.first(count));
}

using Take = std::function<void(const Element&)>;
/// Hands over what is there; returns false when there was nothing.
using Pop = bool (*)(Ring& ring, const Take& take);

bool pop_single(Ring& ring, const Take& take) {
  Element element;
  if (!ring.pop(element)) return false;
  take(element);
  return true;
}

bool pop_in_place(Ring& ring, const Take& take) {
  const Element* const element = ring.front();
  if (element == nullptr) return false;
  take(*element);
  ring.release();
  return true;
}

bool pop_block(Ring& ring, const Take& take) {
  std::array<Element, kBlock> block;
  const std::size_t count = ring.pop(std::span{block});
  std::for_each_n(block.begin(), count, take);
  return count > 0;
}

/// The consumer: takes until the producer is done and the ring is empty, and checks each element; returns how many arrived.
std::uint64_t consume(Ring& ring, Pop pop, const std::atomic<bool>& is_done) {
  std::uint64_t newest = 0;
  std::uint64_t arrived = 0;
  const Take check = [&](const Element& element) {
    ASSERT_TRUE(element.is_whole());
    ASSERT_GT(element.value, newest) << "out of order, or twice";
    newest = element.value;
    ++arrived;
  };
  for (;;) {
    const bool is_last_look = is_done.load(std::memory_order_acquire);  // pairs with the store after the last push
    if (pop(ring, check)) continue;
    if (is_last_look) return arrived;
    std::this_thread::yield();
  }
}

/// Whether enough elements were taken. On a busy machine each yield may cost milliseconds: there some hundred have to do.
bool is_enough(std::uint64_t taken, std::chrono::steady_clock::time_point begun) {
  return taken >= kElements || (taken >= kFewestElements && std::chrono::steady_clock::now() - begun > kLongest);
}

void expect_all_arrive_or_are_counted(Push push, Pop pop, std::size_t capacity) {
  const auto begun = std::chrono::steady_clock::now();
  Ring ring(capacity);
  std::atomic<bool> is_done{false};
  std::uint64_t arrived = 0;
  std::uint64_t taken = 0;
  std::uint64_t sent = 0;
  std::thread consumer([&] { arrived = consume(ring, pop, is_done); });
  while (!is_enough(taken, begun)) {
    const std::size_t taken_now = push(ring, sent + 1, kBlock);  // what was not taken is gone
    sent += kBlock;
    taken += taken_now;
    if (taken_now == 0) std::this_thread::yield();
  }
  is_done.store(true, std::memory_order_release);
  consumer.join();

  EXPECT_EQ(arrived, taken);
  EXPECT_EQ(arrived + ring.dropped(), sent);
}

TEST(SpscRingStress, AnyCalls_EveryElementArrivesOrIsCounted) {
  for (const Push push : {push_single, push_in_place, push_block}) {
    for (const Pop pop : {pop_single, pop_in_place, pop_block}) {
      for (const std::size_t capacity : {1U, 4U, 64U}) expect_all_arrive_or_are_counted(push, pop, capacity);
    }
  }
}

}  // namespace
}  // namespace dts::core
