// SPDX-License-Identifier: Apache-2.0
#include "session/recent_peak.h"

#include <gtest/gtest.h>

#include <numeric>

#include "session/publish_report.h"

namespace dts::session {
namespace {

constexpr std::int64_t kWindowNs = RecentPeak::kWindowNs;
constexpr std::int64_t kStartNs = 1'000'000'000'000;  // of a machine that has run for a while

TEST(RecentPeak, NothingNoted_IsNothing) { EXPECT_EQ(RecentPeak().at(kStartNs), 0U); }

TEST(RecentPeak, ThePeakIsKept_WhateverComesAfterIt) {
  RecentPeak peak;
  peak.note(3, kStartNs);
  peak.note(9, kStartNs + 1);
  peak.note(1, kStartNs + 2);

  EXPECT_EQ(peak.at(kStartNs + 3), 9U);
  EXPECT_EQ(peak.at(kStartNs + 3), 9U) << "looking changes nothing";
}

TEST(RecentPeak, AfterOneWindow_ThePeakStillStandsAndAfterTwoItIsGone) {
  RecentPeak peak;
  peak.note(9, kStartNs);
  peak.note(2, kStartNs + kWindowNs);
  EXPECT_EQ(peak.at(kStartNs + kWindowNs), 9U);

  peak.note(1, kStartNs + 2 * kWindowNs);

  EXPECT_EQ(peak.at(kStartNs + 2 * kWindowNs), 2U);
}

TEST(RecentPeak, SilenceOfTheWriter_AgesThePeakToo) {
  RecentPeak peak;
  peak.note(9, kStartNs);

  EXPECT_EQ(peak.at(kStartNs + 2 * kWindowNs - 1), 9U);
  EXPECT_EQ(peak.at(kStartNs + 2 * kWindowNs), 0U);
}

TEST(RecentPeak, AfterALongSilence_NothingOldComesBack) {
  RecentPeak peak;
  peak.note(9, kStartNs);
  peak.note(1, kStartNs + 10 * kWindowNs);

  EXPECT_EQ(peak.at(kStartNs + 10 * kWindowNs), 1U);
}

TEST(LatencyReport, BoundsBelongToTheirBucket) {
  LatencyReport report;
  report.add(1.0);
  report.add(1.001);
  report.add(1000.0);
  report.add(1000.1);

  EXPECT_EQ(report.blocks[3], 1U) << "0.5 to 1 ms";
  EXPECT_EQ(report.blocks[4], 1U) << "1 to 2 ms";
  EXPECT_EQ(report.blocks[12], 1U);
  EXPECT_EQ(report.blocks[13], 1U) << "longer than all bounds";
  EXPECT_DOUBLE_EQ(report.sum_ms, 2002.101);
}

TEST(LatencyReport, AHostTimeThatLiesAhead_CountsAsNothing) {
  LatencyReport report;

  report.add(-0.3);

  EXPECT_EQ(report.blocks[0], 1U);
  EXPECT_EQ(report.sum_ms, 0.0);
  EXPECT_EQ(std::accumulate(report.blocks.begin(), report.blocks.end(), std::uint64_t{0}), 1U);
}

}  // namespace
}  // namespace dts::session
