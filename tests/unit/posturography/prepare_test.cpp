// SPDX-License-Identifier: Apache-2.0
#include "posturography/prepare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/special_numbers.h"
#include "posturography/butterworth.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

using core::kNaN;
using test::Position;
using test::series_of;
using test::standing;
constexpr Preparation kPrepareAsIs{.profile = Profile::AsIs};

/// 10 s at 100 Hz: ML counts the samples in hundredths from 3 on, AP twice as fast from -7 on.
Position on_ramp(std::size_t i) { return {3.0 + 0.01 * static_cast<double>(i), -7.0 + 0.02 * static_cast<double>(i)}; }
CopSeries ramp(std::size_t count = 1000) { return series_of(100.0, count, on_ramp); }

CopSeries with_gap(CopSeries series, std::size_t begin, std::size_t length) {
  std::fill_n(series.ml_mm.begin() + static_cast<std::ptrdiff_t>(begin), length, kNaN);
  return series;
}

TEST(Prepare, CleanSeries_IsCentredOnly) {
  const auto prepared = prepare(ramp(), kPrepareAsIs);

  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->rate_hz, 100.0);
  EXPECT_EQ(prepared->size(), 1000U);
  EXPECT_EQ(prepared->duration_s(), 10.0);
  EXPECT_EQ(prepared->flags, 0U);
  EXPECT_EQ(prepared->missing, 0U);
  EXPECT_NEAR(prepared->mean_ml_mm, 3.0 + 4.995, 1e-12);
  EXPECT_NEAR(prepared->mean_ap_mm, -7.0 + 9.99, 1e-12);
  EXPECT_NEAR(prepared->ml_mm.front(), -4.995, 1e-12);
  EXPECT_NEAR(std::accumulate(prepared->ap_mm.begin(), prepared->ap_mm.end(), 0.0), 0.0, 1e-7);
}

TEST(Prepare, GapOf50ms_IsInterpolated) {
  CopSeries series = with_gap(ramp(), 300, 5);
  series.ap_mm[310] = std::numeric_limits<double>::infinity();
  series.ml_mm[1] = series.ml_mm[998] = kNaN;

  const auto prepared = prepare(series, kPrepareAsIs);

  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->size(), 1000U);
  EXPECT_EQ(prepared->missing, 8U);
  EXPECT_EQ(prepared->interpolated, 8U);
  EXPECT_EQ(prepared->flags, 0U) << "0.8 % are missing";
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_NEAR(prepared->ml_mm[i] + prepared->mean_ml_mm, on_ramp(i).ml_mm, 1e-12);
    EXPECT_NEAR(prepared->ap_mm[i] + prepared->mean_ap_mm, on_ramp(i).ap_mm, 1e-12);
  }
}

TEST(Prepare, GapOfMoreThan50ms_IsCutAtAndTheLongestStretchKept) {
  RecordProperty("requirement", "SWAY-5");
  const auto prepared = prepare(with_gap(with_gap(ramp(), 300, 6), 900, 3), kPrepareAsIs);

  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->size(), 694U);
  EXPECT_DOUBLE_EQ(prepared->begins_s, 3.06);
  EXPECT_EQ(prepared->flags, sway_flag::kCutAtGap);
  EXPECT_EQ(prepared->missing, 9U);
  EXPECT_EQ(prepared->interpolated, 3U);
  EXPECT_NEAR(prepared->ml_mm.front() + prepared->mean_ml_mm, on_ramp(306).ml_mm, 1e-12);
}

TEST(Prepare, MissingEnds_AreACutToo) {
  RecordProperty("requirement", "SWAY-5");
  const auto prepared = prepare(with_gap(with_gap(ramp(), 0, 30), 980, 20), kPrepareAsIs);

  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->size(), 950U);
  EXPECT_DOUBLE_EQ(prepared->begins_s, 0.3);
  EXPECT_EQ(prepared->missing, 50U);
  EXPECT_EQ(prepared->interpolated, 0U);
  EXPECT_EQ(prepared->flags, sway_flag::kMissingSamples | sway_flag::kCutAtGap);
  using End = std::tuple<std::size_t, std::size_t, bool>;
  for (const auto& [begin, count, is_cut] : {End{0, 5, false}, End{0, 6, true}, End{995, 5, false}, End{994, 6, true}}) {
    const auto one_end = prepare(with_gap(ramp(), begin, count), kPrepareAsIs);
    EXPECT_EQ((one_end->flags & sway_flag::kCutAtGap) != 0, is_cut) << begin << ": a cut is longer than 50 ms";
  }
}

TEST(Prepare, MoreThanOnePercentMissingOrALowRate_IsFlagged) {
  CopSeries ten = ramp();
  for (std::size_t i = 0; i < 10; ++i) ten.ml_mm[50 + 20 * i] = kNaN;
  CopSeries eleven = ten;
  eleven.ml_mm[700] = kNaN;

  EXPECT_EQ(prepare(ten, kPrepareAsIs)->flags, 0U);
  EXPECT_EQ(prepare(eleven, kPrepareAsIs)->flags, sway_flag::kMissingSamples);
  EXPECT_EQ(prepare(standing(1, 49.9, 1000), kPrepareAsIs)->flags, sway_flag::kLowRate);
  EXPECT_EQ(prepare(standing(1, 50.0, 1000), kPrepareAsIs)->flags, 0U);
}

TEST(Prepare, LoadOfNothing_IsMissing) {
  CopSeries series = ramp();
  series.load_n.assign(1000, 700.0);
  series.load_n[500] = 0.0;
  series.load_n[600] = kNaN;  // not known: the position stands

  const auto prepared = prepare(series, kPrepareAsIs);

  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->missing, 1U);
  EXPECT_EQ(prepared->interpolated, 1U);
}

TEST(Prepare, FilteredThenEveryNthThenTrimmed) {
  const CopSeries series = standing(9, 1500.0375, 45'000);
  std::vector<double> filtered = series.ml_mm;
  filter_zero_phase(butterworth4(10.0, series.rate_hz), filtered);

  const auto prepared = prepare(series, {.profile = Profile::Lp10, .analysis_rate_hz = 100.0, .trim_s = 5.0});

  ASSERT_TRUE(prepared);
  EXPECT_DOUBLE_EQ(prepared->rate_hz, 1500.0375 / 15.0);
  EXPECT_EQ(prepared->size(), 3000U - 501U) << "5 s are 500.01 samples";
  EXPECT_DOUBLE_EQ(prepared->begins_s, 501.0 * 15.0 / 1500.0375);
  for (std::size_t i = 0; i < prepared->size(); ++i) EXPECT_NEAR(prepared->ml_mm[i] + prepared->mean_ml_mm, filtered[(501 + i) * 15], 1e-9);
}

TEST(Prepare, ProfileAsIs_NeitherFiltersNorDecimates) {
  const CopSeries series = standing(9, 1000.0, 2000);

  const auto prepared = prepare(series, {.profile = Profile::AsIs, .analysis_rate_hz = 100.0});

  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->rate_hz, 1000.0);
  ASSERT_EQ(prepared->size(), 2000U);
  for (std::size_t i = 0; i < 2000; ++i) EXPECT_NEAR(prepared->ap_mm[i] + prepared->mean_ap_mm, series.ap_mm[i], 1e-12);
  for (const Profile profile : {Profile::AsIs, Profile::Lp10}) EXPECT_EQ(profile_named(name(profile)), profile);
  EXPECT_EQ(name(Profile::Lp10), "lp10");
  EXPECT_FALSE(profile_named("LP10"));
}

TEST(Prepare, SettlingBeginsWithTheFirstSampleThereIs) {
  const auto led = prepare(with_gap(ramp(), 0, 100), {.profile = Profile::AsIs, .trim_s = 2.0});
  const auto cut = prepare(with_gap(ramp(), 300, 10), {.profile = Profile::AsIs, .trim_s = 2.0});

  EXPECT_DOUBLE_EQ(led->begins_s, 3.0);
  EXPECT_DOUBLE_EQ(cut->begins_s, 3.1) << "who was there before the gap has settled";
}

TEST(Prepare, Constant_IsExactlyZero) {
  for (const double level : {17.44378, -1e6 / 3.0, 1e-3}) {
    for (const Profile profile : {Profile::AsIs, Profile::Lp10}) {
      const auto series = with_gap(series_of(100.0, 3000, [&](std::size_t) { return Position{level, 0.1}; }), 200, 4);

      const auto prepared = prepare(series, {.profile = profile});

      ASSERT_TRUE(prepared);
      EXPECT_TRUE(std::all_of(prepared->ml_mm.begin(), prepared->ml_mm.end(), [](double value) { return value == 0.0; })) << level;
      EXPECT_TRUE(std::all_of(prepared->ap_mm.begin(), prepared->ap_mm.end(), [](double value) { return value == 0.0; }));
      EXPECT_EQ(prepared->mean_ml_mm, level);
    }
  }
}

TEST(Prepare, WhatCannotBeAnalysedIsRefused) {
  const auto refusal = [](const CopSeries& series, const Preparation& preparation) {
    const auto prepared = prepare(series, preparation);
    return prepared ? "" : prepared.error().what;
  };
  CopSeries uneven = ramp();
  uneven.ap_mm.pop_back();
  CopSeries loads = ramp();
  loads.load_n = {700.0};
  CopSeries rate = ramp();
  constexpr Preparation kLp10{};

  EXPECT_EQ(refusal(uneven, kPrepareAsIs), "the columns of the centre of pressure are not equally long");
  EXPECT_EQ(refusal(loads, kPrepareAsIs), "the columns of the centre of pressure are not equally long");
  for (const double rate_hz : {10.0, 100'000.0, 0.0, -100.0, kNaN, 9.99, 100'001.0, std::numeric_limits<double>::infinity()}) {
    rate.rate_hz = rate_hz;
    EXPECT_EQ(refusal(rate, kPrepareAsIs),
              rate_hz >= 10.0 && rate_hz <= 1e5 ? "" : "a centre of pressure sampled at " + std::to_string(rate_hz) + " Hz")
        << rate_hz;
  }
  rate.rate_hz = 20.0;
  EXPECT_EQ(refusal(rate, kLp10), "profile lp10 cannot filter 20.000000 Hz at 10 Hz");
  EXPECT_EQ(refusal(rate, kPrepareAsIs), "");
  EXPECT_EQ(refusal(ramp(15), kLp10), "only 15 samples (0.150000 s) are left of the centre of pressure, and 16 are needed");
  EXPECT_EQ(refusal(ramp(16), kLp10), "");
  EXPECT_EQ(refusal(ramp(1), kPrepareAsIs), "only 1 samples (0.010000 s) are left of the centre of pressure, and 2 are needed");
  EXPECT_EQ(refusal(ramp(2), kPrepareAsIs), "");
  for (const CopSeries& nobody : {ramp(0), with_gap(ramp(), 0, 1000)}) {
    EXPECT_EQ(refusal(nobody, kPrepareAsIs), "there is no sample of the centre of pressure");
  }
  EXPECT_EQ(refusal(ramp(), {.profile = Profile::AsIs, .trim_s = 9.99}),
            "only 1 samples (0.010000 s) are left of the centre of pressure, and 2 are needed");
  EXPECT_EQ(refusal(ramp(), {.profile = Profile::AsIs, .trim_s = 9.98}), "");
  EXPECT_EQ(refusal(ramp(), {.profile = Profile::AsIs, .trim_s = 1e300}), "there is no sample of the centre of pressure");
  EXPECT_EQ(refusal(ramp(), {.profile = Profile::AsIs, .trim_s = kNaN}), "the settling time is not valid");
  EXPECT_EQ(refusal(ramp(), {.analysis_rate_hz = -1.0}), "the rate of the analysis is not valid");
  EXPECT_EQ(refusal(ramp(), {.profile = static_cast<Profile>(9)}), "unknown profile");
}

TEST(Prepare, LoadThatGoesAway_IsSteppingOff) {
  CopSeries series = standing(3, 100.0, 3000);
  series.load_n.assign(3000, 700.0);
  CopSeries dip = series;
  std::fill_n(dip.load_n.begin() + 1000, 5, 10.0);
  CopSeries off = series;
  std::fill_n(off.load_n.begin() + 1000, 6, 349.0);
  CopSeries half = series;
  std::fill_n(half.load_n.begin() + 1000, 600, 351.0);
  CopSeries gone = series;  // as a platform tells it: no position without a load
  std::fill(gone.load_n.begin() + 1000, gone.load_n.end(), 0.0);
  CopSeries settling = series;
  std::fill_n(settling.load_n.begin(), 50, 100.0);

  EXPECT_EQ(prepare(series, kReportPreparation)->flags, 0U);
  EXPECT_EQ(prepare(dip, kReportPreparation)->flags, 0U);
  EXPECT_EQ(prepare(half, kReportPreparation)->flags, 0U);
  EXPECT_EQ(prepare(off, kReportPreparation)->flags, sway_flag::kSteppedOff);
  EXPECT_TRUE(prepare(gone, kReportPreparation)->flags & sway_flag::kSteppedOff);
  EXPECT_TRUE(prepare(settling, kReportPreparation)->flags & sway_flag::kSteppedOff);
  EXPECT_EQ(prepare(settling, {.trim_s = 1.0})->flags, 0U);
}

TEST(Prepare, JumpOfThePosition_IsAFootThatMoved) {
  RecordProperty("requirement", "SWAY-4");
  const auto moved = [](double shift_mm, double within_s, double back_after_s = 1e9) {
    CopSeries series = standing(3, 100.0, 3000);
    for (std::size_t i = 0; i < 3000; ++i) {
      const double since = static_cast<double>(i) / 100.0 - 15.0;
      const double going = std::clamp(since / within_s, 0.0, 1.0) - std::clamp((since - back_after_s) / within_s, 0.0, 1.0);
      series.ml_mm[i] += shift_mm * going;
    }
    return prepare(series, kReportPreparation)->flags;
  };

  EXPECT_EQ(moved(0.0, 0.1), 0U);
  EXPECT_EQ(moved(60.0, 0.01), sway_flag::kMoved);
  EXPECT_EQ(moved(-40.0, 0.1), sway_flag::kMoved);
  EXPECT_EQ(moved(15.0, 0.01), 0U) << "within the reach of sway";
  EXPECT_EQ(moved(60.0, 1.0), 0U) << "a lean: 60 mm/s";
  EXPECT_EQ(moved(60.0, 0.01, 0.05), 0U) << "a sensor that was off for a moment, not a foot";
}

TEST(Prepare, JumpWhileSettling_DoesNotCount) {
  CopSeries series = standing(3, 100.0, 3000);
  for (std::size_t i = 0; i < 300; ++i) series.ml_mm[i] += 80.0;

  EXPECT_EQ(prepare(series, kReportPreparation)->flags, sway_flag::kMoved);
  EXPECT_EQ(prepare(series, {.analysis_rate_hz = 100.0, .trim_s = 5.0})->flags, 0U);
}

}  // namespace
}  // namespace dts::posturography
