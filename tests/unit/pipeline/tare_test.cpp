// SPDX-License-Identifier: Apache-2.0
#include "pipeline/tare.h"

#include <gtest/gtest.h>

#include <thread>

namespace dts::pipeline {
namespace {

TEST(Tare, NeverAskedFor_SaysSo) {
  Tare tare;

  EXPECT_EQ(tare.requested(), 0U);
  EXPECT_EQ(tare.latest().outcome, TareOutcome::None);
  EXPECT_EQ(tare.latest().request, 0U);
}

TEST(Tare, Requests_AreNumberedFromOne) {
  Tare tare;

  EXPECT_EQ(tare.request(), 1U);
  EXPECT_EQ(tare.request(), 2U);
  EXPECT_EQ(tare.requested(), 2U);
}

TEST(Tare, AnswersFromAnotherThread_ArriveWholeAndInOrder) {
  constexpr std::uint64_t kRequests = 2000;
  Tare tare;
  std::jthread pipeline([&tare] {
    for (std::uint64_t answered = 0; answered < kRequests;) {
      const std::uint64_t requested = tare.requested();
      if (requested == answered) {
        std::this_thread::yield();
        continue;
      }
      answered = requested;
      TareReport report{.request = answered, .outcome = TareOutcome::Done, .channel_count = 4, .baseline = {}};
      report.baseline.fill(static_cast<double>(answered));
      tare.report(report);
    }
  });

  for (std::uint64_t last = 0; last < kRequests;) {
    if (tare.requested() < kRequests) tare.request();
    const TareReport& report = tare.latest();
    ASSERT_GE(report.request, last);
    last = report.request;
    for (const double baseline : report.baseline) ASSERT_EQ(baseline, static_cast<double>(report.request));
  }
}

}  // namespace
}  // namespace dts::pipeline
