// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "checked.h"

namespace dts::model_check {
namespace {

constexpr unsigned kBroadcaster = 0;
constexpr std::uint64_t kWrittenElements = 4;

/// A writer and a reader at a ring of two slots: four elements of two words, so that every slot is overwritten. What a reader accepts must
/// be the element that it asked for, whole.
template <Weakening weakening>
class BroadcastSuite : public rl::test_suite<BroadcastSuite<weakening>, 2> {
 public:
  using Ring = core::BroadcastRing<With<weakening>::template Atomic>;

  void thread(unsigned index) {
    if (index == kBroadcaster) {
      for (std::uint64_t element = 0; element < kWrittenElements; ++element) ring_->write(std::array{element + 100, element + 100});
    } else {
      follow();
    }
  }

  void follow() {
    std::array<std::uint64_t, 2> out{};
    std::uint64_t next = 0;
    for (std::uint64_t attempt = 0; attempt < kWrittenElements; ++attempt) {
      const std::uint64_t written = ring_->written();
      if (next >= written) continue;
      const auto size = ring_->read(next, out);
      if (size) {
        require(*size == out.size(), "an element is read in its size");
        require(out[0] == next + 100 && out[1] == next + 100, "an element is whole and the wanted one");
      } else {
        require(written + 1 - next > ring_->capacity() || ring_->written() + 1 - next > ring_->capacity(), "only old elements are refused");
      }
      ++next;
    }
  }

 private:
  std::unique_ptr<Ring> ring_ = std::make_unique<Ring>(2, 2);
};

constexpr Search kAllWithThreePreemptions{.kind = rl::sched_bound, .preemptions = 3};

TEST(BroadcastRingModel, AsShipped_PassesEveryBoundedInterleaving) {
  const Verdict verdict = check<BroadcastSuite<Weakening{}>>(kAllWithThreePreemptions);

  EXPECT_EQ(verdict.result, rl::test_result_success) << verdict.report;
}

TEST(BroadcastRingModel, AsShipped_PassesRandomInterleavings) {
  const Verdict verdict = check<BroadcastSuite<Weakening{}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_success) << verdict.report;
}

// The broken twins: a reader accepts a wrong or torn element.

TEST(BroadcastRingModel, WriterWithoutRelease_IsCaught) {
  const Verdict verdict = check<BroadcastSuite<Weakening{.thread = kBroadcaster, .loses_release = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_user_assert_failed) << verdict.report;
}

TEST(BroadcastRingModel, ReaderWithoutAcquire_IsCaught) {
  const Verdict verdict = check<BroadcastSuite<Weakening{.thread = 1, .loses_acquire = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_user_assert_failed) << verdict.report;
}

}  // namespace
}  // namespace dts::model_check
