// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <span>
#include <string>

#include "checked.h"

namespace dts::model_check {
namespace {

constexpr unsigned kProducer = 0;
constexpr unsigned kConsumer = 1;
constexpr std::uint64_t kElements = 4;

/// Two threads at one ring of two slots: four elements, so that it runs full, runs empty and wraps. What went in must
/// come out, in order and whole, or be counted as dropped.
template <class Sides, Weakening weakening>
class RingSuite : public rl::test_suite<RingSuite<Sides, weakening>, 2> {
 public:
  using Ring = core::SpscRing<CheckedElement, With<weakening>::template Atomic>;

  void thread(unsigned index) {
    if (index == kProducer) Sides::produce(*this);
    if (index == kConsumer) Sides::consume(*this);
  }

  void after() {
    while (const CheckedElement* element = ring().front()) {
      arrived(*element);
      ring().release();
    }
    require(arrived_count_ + refused_count_ == kElements, "every element arrives that was taken");
    require(ring().dropped() == refused_count_, "every element is counted that was refused");
  }

  Ring& ring() { return *ring_; }
  void refused(std::uint64_t elements) { refused_count_ += elements; }
  void arrived(const CheckedElement& element) {
    require(element.is_whole(), "no torn element arrives");
    require(element.value() > newest_, "elements arrive once and in order");
    newest_ = element.value();
    ++arrived_count_;
  }

 private:
  std::unique_ptr<Ring> ring_ = std::make_unique<Ring>(2);
  // Bookkeeping of the test: each touched by one thread only until after().
  std::uint64_t refused_count_ = 0;
  std::uint64_t arrived_count_ = 0;
  std::uint64_t newest_ = 0;
};

/// claim and commit, front and release.
struct InPlace {
  template <class Suite>
  static void produce(Suite& suite) {
    for (std::uint64_t value = 1; value <= kElements; ++value) {
      CheckedElement* const slot = suite.ring().claim();
      if (slot == nullptr) {
        suite.ring().drop();
        suite.refused(1);
        continue;
      }
      *slot = CheckedElement{value};
      suite.ring().commit();
    }
  }

  template <class Suite>
  static void consume(Suite& suite) {
    for (std::uint64_t attempt = 0; attempt < kElements; ++attempt) {
      const CheckedElement* const element = suite.ring().front();
      if (element == nullptr) continue;
      suite.arrived(*element);
      suite.ring().release();
    }
  }
};

/// push and pop of single elements.
struct Singles {
  template <class Suite>
  static void produce(Suite& suite) {
    for (std::uint64_t value = 1; value <= kElements; ++value) {
      if (!suite.ring().push(CheckedElement{value})) suite.refused(1);
    }
  }

  template <class Suite>
  static void consume(Suite& suite) {
    CheckedElement element;
    for (std::uint64_t attempt = 0; attempt < kElements; ++attempt) {
      if (suite.ring().pop(element)) suite.arrived(element);
    }
  }
};

/// push and pop of blocks: one that fits, then one that fits in part at best.
struct Blocks {
  template <class Suite>
  static void produce(Suite& suite) {
    const std::array elements{CheckedElement{1}, CheckedElement{2}, CheckedElement{3}, CheckedElement{4}};
    push(suite, std::span{elements}.first(1));
    push(suite, std::span{elements}.last(kElements - 1));
  }

  template <class Suite>
  static void push(Suite& suite, std::span<const CheckedElement> elements) {
    suite.refused(elements.size() - suite.ring().push(elements));
  }

  template <class Suite>
  static void consume(Suite& suite) {
    std::array<CheckedElement, 2> elements;
    for (int attempt = 0; attempt < 3; ++attempt) {
      const std::size_t count = suite.ring().pop(std::span{elements});
      for (const CheckedElement& element : std::span{elements}.first(count)) suite.arrived(element);
    }
  }
};

constexpr Search kAllWithFourPreemptions{.kind = rl::sched_bound, .preemptions = 4};

template <class Sides>
class SpscRingModel : public testing::Test {};
using AllSides = testing::Types<InPlace, Singles, Blocks>;
TYPED_TEST_SUITE(SpscRingModel, AllSides);

TYPED_TEST(SpscRingModel, AsShipped_PassesEveryBoundedInterleaving) {
  const Verdict verdict = check<RingSuite<TypeParam, Weakening{}>>(kAllWithFourPreemptions);

  EXPECT_EQ(verdict.result, rl::test_result_success) << verdict.report;
}

TYPED_TEST(SpscRingModel, AsShipped_PassesRandomInterleavings) {
  const Verdict verdict = check<RingSuite<TypeParam, Weakening{}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_success) << verdict.report;
}

// The broken twins: the shipped code with one memory order taken away. A check that lets one pass checks nothing.

TYPED_TEST(SpscRingModel, HeadStoredRelaxed_IsCaughtAsRace) {
  const Verdict verdict = check<RingSuite<TypeParam, Weakening{.thread = kProducer, .loses_release = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

TYPED_TEST(SpscRingModel, HeadLoadedRelaxed_IsCaughtAsRace) {
  const Verdict verdict = check<RingSuite<TypeParam, Weakening{.thread = kConsumer, .loses_acquire = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

TYPED_TEST(SpscRingModel, TailStoredRelaxed_IsCaughtAsRace) {
  const Verdict verdict = check<RingSuite<TypeParam, Weakening{.thread = kConsumer, .loses_release = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

TYPED_TEST(SpscRingModel, TailLoadedRelaxed_IsCaughtAsRace) {
  const Verdict verdict = check<RingSuite<TypeParam, Weakening{.thread = kProducer, .loses_acquire = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

}  // namespace
}  // namespace dts::model_check
