// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "core/special_numbers.h"
#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
using core::quality::kOutOfRange;
using core::quality::kRail;
using core::quality::kStuck;
using testing::Each;
using testing::ElementsAre;

std::unique_ptr<Stage> window_filter(std::map<std::string, OptionValue, std::less<>> options) {
  StageSurroundings surroundings;
  return surroundings.make({.id = "window_filter", .options = std::move(options)});
}

std::vector<double> counting_up(std::size_t scans) {
  std::vector<double> values(scans);
  std::iota(values.begin(), values.end(), 0.0);
  return values;
}

TEST(WindowFilter, Window_IsAveragedChannelByChannel) {
  RecordProperty("requirement", "SIG-2");
  struct Row {
    std::map<std::string, OptionValue, std::less<>> options;
    std::vector<std::uint64_t> scans;
    std::vector<double> first;   // channel
    std::vector<double> second;  // channel
  };
  const std::vector<Row> rows{{{}, {2, 3, 4}, {3.0, 6.0, 7.0}, {1.0, 2.0, 3.0}},  // the thesis's window of 3, shift of 1
                              {{{"window_scans", 1.0}}, {0, 1, 2, 3, 4}, {3.0, 6.0, 0.0, 12.0, 9.0}, {0.0, 1.0, 2.0, 3.0, 4.0}},
                              {{{"window_scans", 5.0}}, {4}, {6.0}, {2.0}},
                              {{{"window_scans", 6.0}}, {}, {}, {}},
                              {{{"window_ms", 40.0}, {"window_scans", 2.0}}, {3, 4}, {5.25, 6.75}, {1.5, 2.5}}};
  for (const Row& row : rows) {
    const auto filter = window_filter(row.options);

    const Output output = prepare_and_run(*filter, make_signal(100, "V", {{3.0, 6.0, 0.0, 12.0, 9.0}, counting_up(5)}));

    EXPECT_EQ(output.scan, row.scans);
    EXPECT_EQ(output.values[0], row.first);
    EXPECT_EQ(output.values[1], row.second);
    for (const auto& bits : output.bits) EXPECT_THAT(bits, Each(0));
  }
}

TEST(WindowFilter, Delay_IsHalfTheWindowBehindTheLastScan) {
  RecordProperty("requirement", "SIG-3");
  core::StreamFormat input = make_signal(1500, "V", {{}}).format;
  input.delay_ns = 7;

  EXPECT_EQ(window_filter({{"window_scans", 4.0}})->prepare(input, 64)->delay_ns, 1'000'007);  // 1.5 scans of 1/1500 s
  EXPECT_EQ(window_filter({{"window_scans", 1.0}})->prepare(input, 64)->delay_ns, 7);
  EXPECT_EQ(window_filter({})->prepare(make_signal(100, "V", {{}}).format, 64)->delay_ns, 10'000'000);
}

TEST(WindowFilter, Shift_GivesScansWhoseIndexItDivides) {
  RecordProperty("requirement", "SIG-2");
  const auto filter = window_filter({{"window_scans", 3.0}, {"shift_scans", 4.0}});
  const Signal signal = make_signal(100, "V", {counting_up(13)});

  const core::StreamFormat format = filter->prepare(signal.format, 64).value();
  const Output output = prepare_and_run(*filter, signal);

  EXPECT_EQ(format.rate, rate_hz(25));
  EXPECT_THAT(output.scan, ElementsAre(1, 2, 3));  // completed by input scans 4, 8 and 12
  EXPECT_THAT(output.values[0], ElementsAre(3.0, 7.0, 11.0));
  EXPECT_THAT(output.block_host_time_ns, ElementsAre(host_time_ns(signal.format.rate, 4)));
}

TEST(WindowFilter, ShiftInASegmentThatDoesNotBeginAtZero_KeepsToTheIndex) {
  const auto filter = window_filter({{"window_scans", 1.0}, {"shift_scans", 4.0}});
  Signal signal = make_signal(100, "V", {counting_up(8)});
  signal.first_scan = 102;

  const Output output = prepare_and_run(*filter, signal);

  EXPECT_THAT(output.scan, ElementsAre(26, 27));
  EXPECT_THAT(output.values[0], ElementsAre(2.0, 6.0));
}

TEST(WindowFilter, NaNInTheWindow_MakesNaNAndIsGoneWithIt) {
  const auto filter = window_filter({});
  Signal signal = make_signal(100, "V", {{1.0, 2.0, 3.0, kNaN, 5.0, 6.0, 7.0, 8.0}});
  signal.bits[0][3] = kRail;

  const Output output = prepare_and_run(*filter, signal);

  EXPECT_EQ(output.values[0][0], 2.0);
  for (const std::size_t i : {1U, 2U, 3U}) EXPECT_TRUE(std::isnan(output.values[0][i])) << i;
  EXPECT_EQ(output.values[0][4], 6.0);
  EXPECT_EQ(output.values[0][5], 7.0);
  EXPECT_THAT(output.bits[0], ElementsAre(0, kRail, kRail, kRail, 0, 0));
}

TEST(WindowFilter, NaNWithoutBits_IsExplained) {
  const auto filter = window_filter({{"window_scans", 2.0}});

  const Output output = prepare_and_run(*filter, make_signal(100, "V", {{kNaN, 1.0, 2.0}}));

  EXPECT_THAT(output.bits[0], ElementsAre(kOutOfRange, 0));
}

TEST(WindowFilter, Quality_IsTheOrOfTheWindow) {
  const auto filter = window_filter({});
  Signal signal = make_signal(100, "V", {counting_up(7)});
  signal.bits[0] = {kRail, 0, kStuck, 0, 0, 0, kRail};

  const Output output = prepare_and_run(*filter, signal);

  EXPECT_THAT(output.bits[0], ElementsAre(kRail | kStuck, kStuck, kStuck, 0, kRail));
}

TEST(WindowFilter, Reset_WaitsForAFullWindowAgain) {
  const auto filter = window_filter({{"window_scans", 2.0}});
  prepare_and_run(*filter, make_signal(100, "V", {{100.0, kNaN, 100.0}}));
  const std::size_t block_size = 64;

  filter->reset();
  const Output output = run(*filter, 1, make_signal(100, "V", {{1.0, 3.0}}), std::span(&block_size, 1));

  EXPECT_THAT(output.values[0], ElementsAre(2.0));
  EXPECT_THAT(output.bits[0], ElementsAre(0));
}

TEST(WindowFilter, HugeValue_LeavesNoTraceOnceOutOfTheWindow) {
  for (const double window : {2.0, 3.0, 7.0, 100.0}) {
    const auto filter = window_filter({{"window_scans", window}});
    std::vector<double> values(1000, 0.5);
    values[150] = 1e300;

    const Output output = prepare_and_run(*filter, make_signal(100, "V", {values}));

    // A running sum that takes the value away again is left with 0 here.
    EXPECT_EQ(output.values[0].back(), 0.5) << window;
  }
}

TEST(WindowFilter, HundredThousandScansOfNoise_AgreeWithTheDirectMean) {
  constexpr std::size_t kWindow = 1000;
  const auto filter = window_filter({{"window_scans", static_cast<double>(kWindow)}});
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(2.5, 1.0);
  std::vector<double> values(100'000);
  for (double& value : values) value = noise(random);

  const Output output = prepare_and_run(*filter, make_signal(1500, "V", {values}));

  ASSERT_EQ(output.values[0].size(), values.size() - kWindow + 1);
  for (std::size_t last = kWindow - 1; last < values.size(); last += 97) {
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(last) + 1;
    const double mean = std::accumulate(end - kWindow, end, 0.0) / kWindow;
    // Two orders of adding a thousand numbers: half a thousand roundings each at most, a few in practice.
    ASSERT_NEAR(output.values[0][last - (kWindow - 1)], mean, 2.5 * 500 * std::numeric_limits<double>::epsilon());
  }
}

}  // namespace
}  // namespace dts::pipeline
