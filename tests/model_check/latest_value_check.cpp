// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "checked.h"

namespace dts::model_check {
namespace {

constexpr unsigned kWriter = 0;
constexpr unsigned kReader = 1;
constexpr std::uint64_t kStores = 5;
constexpr std::uint64_t kLoads = 5;

/// A writer storing 1 to 5 and a reader: it sees whole values that never go back, and the last one at the end.
template <Weakening weakening>
class LatestValueSuite : public rl::test_suite<LatestValueSuite<weakening>, 2> {
 public:
  using Value = core::LatestValue<CheckedElement, With<weakening>::template Atomic>;

  void thread(unsigned index) {
    if (index == kWriter) {
      for (std::uint64_t value = 1; value <= kStores; ++value) value_->store(CheckedElement{value});
    }
    if (index == kReader) {
      for (std::uint64_t i = 0; i < kLoads; ++i) look();
    }
  }

  void after() {
    look();
    require(newest_ == kStores, "the last value stored is the one loaded in the end");
  }

 private:
  void look() {
    const CheckedElement& element = value_->load();
    require(element.is_whole(), "no torn value is loaded");
    require(element.value() >= newest_, "values never go back");
    newest_ = element.value();
  }

  std::unique_ptr<Value> value_ = std::make_unique<Value>();
  std::uint64_t newest_ = 0;  // of the reader, until after()
};

constexpr Search kAll{.kind = rl::sched_full};

TEST(LatestValueModel, AsShipped_PassesEveryInterleaving) {
  const Verdict verdict = check<LatestValueSuite<Weakening{}>>(kAll);

  EXPECT_EQ(verdict.result, rl::test_result_success) << verdict.report;
}

TEST(LatestValueModel, AsShipped_PassesRandomInterleavings) {
  const Verdict verdict = check<LatestValueSuite<Weakening{}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_success) << verdict.report;
}

// The broken twins: the shipped code with one half of one acq_rel taken away. A check that lets one pass checks nothing.

TEST(LatestValueModel, WriterSwapsWithoutRelease_IsCaughtAsRace) {
  const Verdict verdict = check<LatestValueSuite<Weakening{.thread = kWriter, .loses_release = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

TEST(LatestValueModel, WriterSwapsWithoutAcquire_IsCaughtAsRace) {
  const Verdict verdict = check<LatestValueSuite<Weakening{.thread = kWriter, .loses_acquire = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

TEST(LatestValueModel, ReaderSwapsWithoutRelease_IsCaughtAsRace) {
  const Verdict verdict = check<LatestValueSuite<Weakening{.thread = kReader, .loses_release = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

TEST(LatestValueModel, ReaderSwapsWithoutAcquire_IsCaughtAsRace) {
  const Verdict verdict = check<LatestValueSuite<Weakening{.thread = kReader, .loses_acquire = true}>>(kAtRandom);

  EXPECT_EQ(verdict.result, rl::test_result_data_race) << verdict.report;
}

}  // namespace
}  // namespace dts::model_check
