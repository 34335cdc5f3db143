// SPDX-License-Identifier: Apache-2.0
#include "posturography/recent_sway.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace dts::posturography {
namespace {

double ml_at(std::uint64_t index) { return 300.0 + 4.0 * std::sin(0.31 * static_cast<double>(index)); }
double ap_at(std::uint64_t index) { return -80.0 + 7.0 * std::cos(0.17 * static_cast<double>(index)); }

/// Ten samples a chunk, at most three chunks.
RecentSwaySums after(std::uint64_t samples) {
  RecentSwaySums sums(100.0, 3);
  for (std::uint64_t i = 0; i < samples; ++i) {
    sums.add(ml_at(i), ap_at(i), i);
    if (i % 10 == 9) sums.end_chunk();
  }
  return sums;
}

void expect_sums_of(const RecentSwaySums& recent, std::uint64_t first, std::uint64_t end) {
  RunningSwaySums exact(100.0);
  for (std::uint64_t i = first; i < end; ++i) exact.add(ml_at(i), ap_at(i));
  const core::RunningSway expected = exact.values();
  const core::RunningSway values = recent.values();
  EXPECT_EQ(recent.first_index(), first);
  EXPECT_EQ(values.samples, expected.samples);
  EXPECT_NEAR(values.mean_ml_mm, expected.mean_ml_mm, 1e-10);
  EXPECT_NEAR(values.mean_ap_mm, expected.mean_ap_mm, 1e-10);
  EXPECT_NEAR(values.rdist_mm, expected.rdist_mm, 1e-10);
  EXPECT_NEAR(values.totex_mm, expected.totex_mm, 1e-9);
  EXPECT_NEAR(values.totex_ml_mm, expected.totex_ml_mm, 1e-9);
  EXPECT_NEAR(values.totex_ap_mm, expected.totex_ap_mm, 1e-9);
  EXPECT_EQ(values.range_ml_mm, expected.range_ml_mm);
  EXPECT_EQ(values.range_ap_mm, expected.range_ap_mm);
  EXPECT_NEAR(values.pea95_f_mm2, expected.pea95_f_mm2, 1e-8);
  EXPECT_NEAR(values.ellipse_angle_deg, expected.ellipse_angle_deg, 1e-8);
}

TEST(RecentSway, Values_AreThoseOfTheNewestChunks) {
  expect_sums_of(after(7), 0, 7);
  expect_sums_of(after(10), 0, 10);
  expect_sums_of(after(30), 0, 30);
  expect_sums_of(after(31), 10, 31);
  expect_sums_of(after(1000), 970, 1000);
  expect_sums_of(after(1004), 980, 1004);
  EXPECT_EQ(after(0).values().samples, 0U);
  EXPECT_EQ(after(0).first_index(), 0U);
}

TEST(RecentSway, State_ContinuesToTheBit) {
  for (const std::uint64_t samples : {0U, 7U, 10U, 34U, 40U}) {
    RecentSwaySums original = after(samples);
    std::vector<double> state(original.state_size());
    original.save(state);
    RecentSwaySums restored(100.0, 3);
    ASSERT_TRUE(restored.restore(state)) << samples;
    for (std::uint64_t i = samples; i < samples + 25; ++i) {
      original.add(ml_at(i), ap_at(i), i);
      restored.add(ml_at(i), ap_at(i), i);
    }
    EXPECT_EQ(restored.first_index(), original.first_index());
    EXPECT_EQ(restored.values().totex_mm, original.values().totex_mm);
    EXPECT_EQ(restored.values().rdist_mm, original.values().rdist_mm);
    EXPECT_EQ(restored.values().range_ap_mm, original.values().range_ap_mm);
  }
}

TEST(RecentSway, ImpossibleState_IsRejected) {
  std::vector<double> good(after(34).state_size());
  after(34).save(good);
  const std::size_t chunk = 3 + RunningSwaySums::kStateSize;
  struct Change {
    std::size_t at;
    double value;
  };
  for (const auto& [at, value] : std::vector<Change>{{0, -2.0},
                                                     {0, 1.0},
                                                     {0, 8.0},
                                                     {0, 2.5},
                                                     {0, std::nan("")},
                                                     {1, -1.0},
                                                     {1, 1e300},
                                                     {1, 0.5},
                                                     {1 + chunk, 0.0},
                                                     {2, std::nan("")},
                                                     {3, 1e300},
                                                     {4, 0.0},
                                                     {4, -1.0}}) {
    std::vector<double> state = good;
    state[at] = value;
    RecentSwaySums sums(100.0, 3);
    EXPECT_FALSE(sums.restore(state)) << at << ": " << value;
    EXPECT_EQ(sums.values().samples, 0U);
  }
  RecentSwaySums sums(100.0, 3);
  EXPECT_FALSE(sums.restore(std::vector<double>(5)));
}

}  // namespace
}  // namespace dts::posturography
