// SPDX-License-Identifier: Apache-2.0
// Posturography sheet section 7: what is left out and what is said when a trial is short, still, incomplete or odd.
#include "posturography/analysis.h"
#include "core/special_numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

using test::Position;
using test::series_of;
using test::standing;

constexpr AnalysisOptions kAsIs{.preparation = {.profile = Profile::AsIs}};

bool is_one_of(Measure measure, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [measure](std::string_view beginning) { return info(measure).symbol.starts_with(beginning); });
}
bool is_quantile(Measure measure) { return is_one_of(measure, {"PF50", "PF95"}); }
bool is_frequency(Measure measure) { return is_quantile(measure) || is_one_of(measure, {"POWER", "CFREQ", "FREQD", "MPF"}); }
bool is_diffusion(Measure measure) { return is_one_of(measure, {"SDA"}); }
bool is_random_walk(Measure measure) { return is_diffusion(measure) || is_one_of(measure, {"MSD"}); }
bool is_entropy(Measure measure) { return is_one_of(measure, {"SAMPEN"}); }

template <class Predicate>
std::size_t count_of(const Analysis& analysis, Predicate is_meant) {
  std::size_t count = 0;
  for (std::size_t index = 0; index < kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    if (is_meant(measure) && analysis.measures.has(measure)) ++count;
  }
  return count;
}

TEST(Analysis, WholeMinute_HasEveryMeasure) {
  const auto analysis = analyse(standing(1, 100.0, 6000), {.preparation = kReportPreparation, .foot_length_mm = 260.0});

  ASSERT_TRUE(analysis);
  EXPECT_EQ(analysis->flags, 0U);
  EXPECT_TRUE(analysis->is_valid());
  EXPECT_EQ(analysis->samples, 6000U);
  EXPECT_EQ(analysis->duration_s, 60.0);
  for (std::size_t index = 0; index < kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    if (is_one_of(measure, {"SDA_TC"})) continue;  // only where short-term diffusion is twice the long-term one
    EXPECT_TRUE(analysis->measures.has(measure)) << info(measure).symbol;
  }
}

TEST(Analysis, LengthAndRateDecideWhatIsDefined) {
  struct Case {
    double rate_hz;
    std::size_t samples;
    Profile profile;
    std::uint32_t flags;
    bool has_entropy = true;
  };
  using namespace sway_flag;
  constexpr std::uint32_t kNoQuantiles = kShortForDiffusion | kShortForQuantiles;
  constexpr Profile kLp10 = Profile::Lp10;
  for (const Case& each : {Case{100.0, 3000, kLp10, 0}, Case{100.0, 2999, kLp10, kShortForDiffusion},
                           Case{100.0, 2000, kLp10, kShortForDiffusion}, Case{100.0, 1999, kLp10, kNoQuantiles},
                           Case{100.0, 1000, kLp10, kNoQuantiles}, Case{100.0, 999, kLp10, kNoQuantiles | kShortRecord, false},
                           Case{100.0, 3000, Profile::AsIs, 0, false},  // entropy and heading would be those of the sensor
                           Case{1500.0375, 45'000, kLp10, 0},           // 30 s by a clock that is a little fast: 29.99925 s
                           Case{1000.0, 30'000, kLp10, 0}, Case{75.0, 3000, kLp10, kOffRates}, Case{75.0, 3000, Profile::AsIs, 0, false},
                           Case{12.0, 200, Profile::AsIs, kLowRate | kNoQuantiles, false},
                           Case{12.0, 199, Profile::AsIs, kLowRate | kNoQuantiles | kShortRecord, false},
                           Case{30.0, 399, kLp10, kLowRate | kOffRates | kNoQuantiles},  // of 15 Hz 200 samples are left
                           Case{30.0, 398, kLp10, kLowRate | kOffRates | kNoQuantiles, false},
                           Case{40.0, 144'001, kLp10, kLowRate | kOffRates | kLongForEntropy, false}}) {
    SCOPED_TRACE(testing::Message() << each.samples << " samples at " << each.rate_hz << " Hz");
    const auto analysis = analyse(standing(1, each.rate_hz, each.samples),
                                  {.preparation = {.profile = each.profile, .analysis_rate_hz = kReportPreparation.analysis_rate_hz}});

    ASSERT_TRUE(analysis);
    EXPECT_EQ(analysis->flags & ~kUnclearCriticalPoint, each.flags);
    const bool is_short = (each.flags & kShortRecord) != 0;
    EXPECT_EQ(count_of(*analysis, is_diffusion) == 0, (each.flags & kShortForDiffusion) != 0);
    EXPECT_EQ(count_of(*analysis, is_quantile) == 0, (each.flags & kShortForQuantiles) != 0);
    EXPECT_EQ(count_of(*analysis, is_frequency) == 0, is_short);
    EXPECT_EQ(count_of(*analysis, is_random_walk) == 0, is_short);
    EXPECT_EQ(count_of(*analysis, is_entropy), each.has_entropy ? 2U : 0U);
    EXPECT_EQ(analysis->measures.has(Measure::HcSd), each.profile == Profile::Lp10);
    EXPECT_TRUE(analysis->measures.has(Measure::Pea95F));
    EXPECT_TRUE(analysis->measures.has(Measure::MveloAp));
  }
}

TEST(Analysis, CriticalTimeWhereShortTermDiffusionIsNotTwiceTheLongTermOne_IsFlagged) {
  std::size_t unclear = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    // A random walk has no critical point; chance makes one of its lines steeper now and then.
    test::Noise noise(seed);
    Position place{};
    const auto walk = series_of(20.0, 1200, [&](std::size_t) {
      return place = {place.ml_mm + noise.normal(), place.ap_mm + noise.normal()};
    });
    for (const CopSeries& series : {walk, standing(seed, 20.0, 1200)}) {
      const auto analysis = analyse(series, kAsIs);
      ASSERT_TRUE(analysis);
      const auto is_unclear = [&](Measure brief, Measure lasting, Measure critical) {
        const Measures& measures = analysis->measures;
        return measures.has(critical) && *measures.get(brief) <= 2.0 * *measures.get(lasting);
      };
      const bool expected = is_unclear(Measure::SdaDsRes, Measure::SdaDlRes, Measure::SdaTcRes) ||
                            is_unclear(Measure::SdaDsAp, Measure::SdaDlAp, Measure::SdaTcAp) ||
                            is_unclear(Measure::SdaDsMl, Measure::SdaDlMl, Measure::SdaTcMl);
      EXPECT_EQ(analysis->flags, sway_flag::kLowRate | (expected ? sway_flag::kUnclearCriticalPoint : 0U)) << seed;
      unclear += expected ? 1U : 0U;
    }
  }
  EXPECT_GT(unclear, 5U);
  EXPECT_LT(unclear, 75U);
}

TEST(Analysis, Constant_HasZerosAndNoQuotients) {
  for (const AnalysisOptions& options : {kAsIs, test::kReportOptions}) {
    const auto analysis = analyse(series_of(100.0, 6000, [](std::size_t) { return Position{17.44378, -1e6 / 3.0}; }), options);

    ASSERT_TRUE(analysis);
    EXPECT_EQ(analysis->flags, sway_flag::kConstant);
    for (const Measure measure :
         {Measure::Mdist,     Measure::MdistMl, Measure::Rdist,    Measure::RdistAp, Measure::Totex,  Measure::TotexAp, Measure::Mvelo,
          Measure::Range,     Measure::RangeMl, Measure::Maxdist,  Measure::Sd1Ap,   Measure::AreaCc, Measure::AreaCe,  Measure::Pea95F,
          Measure::Pea95Chi2, Measure::EllSd1,  Measure::AreaHull, Measure::AreaSw,  Measure::VmaxAp, Measure::Aamv2sMl}) {
      EXPECT_EQ(analysis->measures.get(measure), 0.0) << info(measure).symbol;
    }
    const auto is_quotient = [](Measure measure) {
      return is_one_of(measure,
                       {"MFREQ", "FD_", "LFS", "PF50", "PF95", "CFREQ", "FREQD", "MPF", "SAMPEN", "HC_", "ELL_ANGLE", "SDA_H", "SDA_TC"});
    };
    EXPECT_EQ(count_of(*analysis, is_quotient), 0U);
  }
}

TEST(Analysis, ConstantAxis_HasNoRatiosOfThatAxis) {
  CopSeries series = standing(1, 100.0, 6000);
  std::fill(series.ml_mm.begin(), series.ml_mm.end(), 17.44378);

  const auto analysis = analyse(series, test::kReportOptions);

  ASSERT_TRUE(analysis);
  EXPECT_EQ(analysis->flags, sway_flag::kConstantAxis);
  EXPECT_EQ(analysis->measures.get(Measure::Pea95F), 0.0);
  EXPECT_EQ(analysis->measures.get(Measure::AreaHull), 0.0);
  EXPECT_EQ(analysis->measures.get(Measure::AreaSw), 0.0);
  EXPECT_EQ(analysis->measures.get(Measure::MdistMl), 0.0);
  EXPECT_EQ(analysis->measures.get(Measure::EllAngle), 90.0);
  for (const Measure measure : {Measure::FdCe, Measure::Lfs, Measure::MfreqMl, Measure::Pf50Ml, Measure::Pf95Ml, Measure::CfreqMl,
                                Measure::FreqdMl, Measure::MpfMl, Measure::SampenMl, Measure::SdaHsMl, Measure::SdaTcMl}) {
    EXPECT_FALSE(analysis->measures.has(measure)) << info(measure).symbol;
  }
  for (const Measure measure : {Measure::MfreqAp, Measure::Pf50Ap, Measure::CfreqAp, Measure::SampenAp, Measure::SdaHsAp}) {
    EXPECT_TRUE(analysis->measures.has(measure)) << info(measure).symbol;
  }
  std::swap(series.ml_mm, series.ap_mm);
  const auto sideways = analyse(series, test::kReportOptions);
  EXPECT_EQ(sideways->flags, sway_flag::kConstantAxis);
  EXPECT_EQ(sideways->measures.get(Measure::EllAngle), 0.0);
  EXPECT_FALSE(sideways->measures.has(Measure::MfreqAp));
}

TEST(Analysis, FlagsOfTheSeriesAndCountsAreKept) {
  CopSeries series = standing(1, 100.0, 6000);
  series.flags = sway_flag::kResampled | sway_flag::kDoubtful;
  series.ml_mm[3000] = std::numeric_limits<double>::quiet_NaN();

  const auto analysis = analyse(series, test::kReportOptions);

  ASSERT_TRUE(analysis);
  EXPECT_EQ(analysis->flags, sway_flag::kResampled | sway_flag::kDoubtful);
  EXPECT_EQ(analysis->missing, 1U);
  EXPECT_EQ(analysis->interpolated, 1U);
}

TEST(Analysis, SteppedOffOrMoved_IsNotValid) {
  EXPECT_FALSE(Analysis{.flags = sway_flag::kSteppedOff}.is_valid());
  EXPECT_FALSE(Analysis{.flags = sway_flag::kMoved}.is_valid());
  EXPECT_TRUE(Analysis{.flags = sway_flag::kDoubtful | sway_flag::kCutAtGap}.is_valid());
}

TEST(Analysis, NothingPrepared_HasNoMeasures) {
  EXPECT_EQ(analyse(Prepared{}).measures.count(), 0U);
  EXPECT_EQ(analyse(Prepared{.rate_hz = 100.0}).measures.count(), 0U);
  EXPECT_EQ(analyse(Prepared{.rate_hz = 100.0, .ml_mm = {1.0, 2.0}, .ap_mm = {1.0}}).measures.count(), 0U);
  EXPECT_EQ(analyse(Prepared{.rate_hz = 100.0, .ml_mm = {1.0, NAN}, .ap_mm = {1.0, 2.0}}).measures.count(), 0U);
  EXPECT_EQ(analyse(Prepared{.rate_hz = INFINITY, .ml_mm = {1.0, 2.0}, .ap_mm = {1.0, 2.0}}).measures.count(), 0U);
}

/// Inputs that nobody sends on purpose.
std::vector<CopSeries> odd_series() {
  constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
  std::vector<CopSeries> all;
  const auto add = [&](double rate_hz, std::size_t count, auto point_at) { all.push_back(series_of(rate_hz, count, point_at)); };
  for (const double rate_hz : {10.0, 20.000001, 33.3, 99.7, 1024.0, 100'000.0}) {
    for (const std::size_t count : {2U, 3U, 15U, 16U, 17U, 199U, 200U, 1201U, 3100U}) all.push_back(standing(count, rate_hz, count));
  }
  for (const double level : {0.0, -0.0, 0.1, 1e6, -1e9, 1e10, 1e300, -1e300, kDenormal, core::kNaN, core::kInfinity}) {
    add(100.0, 1500, [&](std::size_t) { return Position{level, level}; });
    add(100.0, 1500, [&](std::size_t i) { return Position{level, std::sin(0.1 * static_cast<double>(i))}; });
    add(100.0, 1500, [&](std::size_t i) { return Position{std::sin(0.1 * static_cast<double>(i)), i % 2 == 0 ? level : -level}; });
    add(100.0, 1500, [&](std::size_t i) { return Position{i == 700 ? level : 0.0, i < 700 ? level : 0.0}; });
  }
  for (const double scale : {1e-320, 1e-300, 1e-160, 1e-12, 1e8}) {
    CopSeries series = standing(5, 100.0, 3200);
    for (double& value : series.ml_mm) value *= scale;
    for (double& value : series.ap_mm) value *= scale;
    all.push_back(series);
  }
  CopSeries far = standing(5, 100.0, 3200);
  for (double& value : far.ml_mm) value += 9e8;
  all.push_back(far);
  CopSeries ends = standing(5, 100.0, 3200);
  std::fill_n(ends.ml_mm.begin(), 150, core::kNaN);
  std::fill_n(ends.ap_mm.end() - 150, 150, core::kInfinity);
  all.push_back(ends);
  CopSeries holes = standing(5, 100.0, 3200);
  for (std::size_t i = 0; i < 3200; i += 2) holes.ml_mm[i] = core::kNaN;
  all.push_back(holes);
  for (const double load : {0.0, -700.0, 1e-300, 1e300, core::kNaN, core::kInfinity}) {
    CopSeries loaded = standing(5, 100.0, 3200);
    loaded.load_n.assign(3200, load);
    all.push_back(loaded);
    loaded.load_n[1600] = 700.0;
    all.push_back(loaded);
  }
  return all;
}

TEST(Analysis, OddInputs_AreRefusedOrHaveFiniteMeasures) {
  constexpr std::array kOptions = {kAsIs, test::kReportOptions, AnalysisOptions{},
                                   AnalysisOptions{.preparation = {.analysis_rate_hz = 1e-300}, .foot_length_mm = 1e-310},
                                   AnalysisOptions{.preparation = {.profile = Profile::AsIs, .trim_s = 1.0},
                                                   .foot_length_mm = std::numeric_limits<double>::quiet_NaN()}};
  std::size_t analysed = 0;
  for (const CopSeries& series : odd_series()) {
    for (const AnalysisOptions& options : kOptions) {
      const auto analysis = analyse(series, options);
      if (!analysis) {
        EXPECT_FALSE(analysis.error().what.empty());
        continue;
      }
      ++analysed;
      EXPECT_TRUE(std::isfinite(analysis->duration_s));
      EXPECT_LT(analysis->flags, 1U << sway_flag::kCount);
      EXPECT_LE(analysis->samples, series.ml_mm.size());
      for (std::size_t index = 0; index < kMeasureCount; ++index) {
        const auto value = analysis->measures.get(static_cast<Measure>(index));
        EXPECT_TRUE(!value || std::isfinite(*value)) << info(static_cast<Measure>(index)).symbol;
      }
    }
  }
  EXPECT_GT(analysed, 300U);
}

}  // namespace
}  // namespace dts::posturography
