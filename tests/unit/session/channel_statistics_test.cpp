// SPDX-License-Identifier: Apache-2.0
#include "session/channel_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace dts::session {
namespace {

core::Block block_of(std::initializer_list<double> values) {
  core::Block block(1, values.size());
  block.set_count(values.size());
  std::ranges::copy(values, block.column(0).begin());
  return block;
}

TEST(StatisticsCollector, PeriodNotFull_ReportsNothing) {
  StatisticsCollector collector(1, 4);

  collector.add(block_of({1.0, 2.0, 3.0}));

  EXPECT_EQ(collector.latest().scans, 0U);
}

TEST(StatisticsCollector, FullPeriod_ReportsMeanNoiseAndExtremes) {
  StatisticsCollector collector(1, 4);

  collector.add(block_of({4.0, 6.0}));
  collector.add(block_of({4.0, 6.0}));

  const StatisticsReport report = collector.latest();
  EXPECT_EQ(report.scans, 4U);
  EXPECT_DOUBLE_EQ(report.channels[0].mean, 5.0);
  EXPECT_DOUBLE_EQ(report.channels[0].noise_rms, 1.0);
  EXPECT_DOUBLE_EQ(report.channels[0].minimum, 4.0);
  EXPECT_DOUBLE_EQ(report.channels[0].maximum, 6.0);
}

TEST(StatisticsCollector, SmallNoiseOnALargeSignal_IsNotLost) {
  StatisticsCollector collector(1, 1000);
  for (int pair = 0; pair < 500; ++pair) collector.add(block_of({1e6 + 1e-6, 1e6 - 1e-6}));

  EXPECT_NEAR(collector.latest().channels[0].noise_rms, 1e-6, 1e-9);
}

TEST(StatisticsCollector, BlockOfAnotherShape_IsIgnored) {
  StatisticsCollector collector(2, 1);

  collector.add(block_of({1.0}));

  EXPECT_EQ(collector.latest().scans, 0U);
}

}  // namespace
}  // namespace dts::session
