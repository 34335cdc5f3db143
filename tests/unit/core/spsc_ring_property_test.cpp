// SPDX-License-Identifier: Apache-2.0
// Any sequence of calls does to SpscRing what it does to a bounded std::deque. One thread: what two threads do to each
// other is the subject of spsc_ring_stress_test.cpp and tests/model_check.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <deque>
#include <vector>

#include "core/spsc_ring.h"

namespace dts::core {
namespace {

enum class Call : std::uint8_t { PushOne, PushBlock, ClaimCommit, PopOne, PopBlock, FrontRelease };

/// The ring and its model, given the same calls.
class Pair {
 public:
  explicit Pair(std::size_t minimum_capacity) : ring_(minimum_capacity) {}

  void call(Call which, std::size_t block_size) {
    switch (which) {
      case Call::PushOne: return push_one();
      case Call::PushBlock: return push_block(block_size);
      case Call::ClaimCommit: return claim_commit();
      case Call::PopOne: return pop_one();
      case Call::PopBlock: return pop_block(block_size);
      case Call::FrontRelease: return front_release();
    }
  }

  void check_dropped() const { RC_ASSERT(ring_.dropped() == dropped_); }

 private:
  bool model_push(std::uint64_t value) {
    const bool has_room = model_.size() < ring_.capacity();
    if (has_room) model_.push_back(value);
    dropped_ += has_room ? 0 : 1;
    return has_room;
  }

  void push_one() {
    const std::uint64_t value = next_++;
    RC_ASSERT(ring_.push(value) == model_push(value));
  }

  void push_block(std::size_t size) {
    std::vector<std::uint64_t> block(size);
    std::size_t expected = 0;
    for (std::uint64_t& value : block) {
      value = next_++;
      expected += model_push(value) ? 1 : 0;
    }
    RC_ASSERT(ring_.push(block) == expected);
  }

  void claim_commit() {
    const std::uint64_t value = next_++;
    std::uint64_t* const slot = ring_.claim();
    RC_ASSERT((slot != nullptr) == model_push(value));
    if (slot == nullptr) {
      ring_.drop();
      return;
    }
    *slot = value;
    ring_.commit();
  }

  void pop_one() {
    std::uint64_t value = 0;
    RC_ASSERT(ring_.pop(value) == !model_.empty());
    if (model_.empty()) return;
    RC_ASSERT(value == model_.front());
    model_.pop_front();
  }

  void pop_block(std::size_t size) {
    std::vector<std::uint64_t> block(size);
    const std::size_t count = ring_.pop(block);
    RC_ASSERT(count == std::min(size, model_.size()));
    for (std::size_t i = 0; i < count; ++i) {
      RC_ASSERT(block[i] == model_.front());
      model_.pop_front();
    }
  }

  void front_release() {
    const std::uint64_t* const slot = ring_.front();
    RC_ASSERT((slot != nullptr) == !model_.empty());
    if (slot == nullptr) return;
    RC_ASSERT(*slot == model_.front());
    ring_.release();
    model_.pop_front();
  }

  SpscRing<std::uint64_t> ring_;
  std::deque<std::uint64_t> model_;
  std::uint64_t dropped_ = 0;
  std::uint64_t next_ = 1;
};

RC_GTEST_PROP(SpscRingProperty, AnyCalls_BehaveAsABoundedDeque, ()) {
  Pair pair(*rc::gen::inRange<std::size_t>(0, 20));
  const auto calls = *rc::gen::container<std::vector<std::pair<int, std::size_t>>>(
      rc::gen::pair(rc::gen::inRange(0, 6), rc::gen::inRange<std::size_t>(0, 40)));

  for (const auto& [which, block_size] : calls) pair.call(static_cast<Call>(which), block_size);

  pair.check_dropped();
}

}  // namespace
}  // namespace dts::core
