// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

#include "core/special_numbers.h"
#include "posturography/cop_series.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

using core::kNaN;

/// Times of rows that may be uneven, and values that are known at any time.
struct Table {
  std::vector<double> t_s;
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;

  void add(double t) {
    t_s.push_back(t);
    ml_mm.push_back(ml_at(t));
    ap_mm.push_back(1.0 - 2.0 * t);
  }
  static double ml_at(double t) { return std::sin(2.0 * t); }
  [[nodiscard]] core::Result<CopSeries> even() const { return even_series(t_s, ml_mm, ap_mm); }
};

double written(double t, int decimals) { return std::round(t * std::pow(10.0, decimals)) / std::pow(10.0, decimals); }

Table regular(double rate_hz, std::size_t rows, int decimals, double begin_s = 0.0) {
  Table table;
  for (std::size_t i = 0; i < rows; ++i) table.add(written(begin_s + static_cast<double>(i) / rate_hz, decimals));
  return table;
}

TEST(EvenSeries, WrittenStampsOfWholeRates_GiveTheRatesExactly) {
  struct Case {
    double rate_hz;
    int decimals;
    double seconds;
    double begin_s = 0.01;
  };
  for (const Case& each : {Case{100.0, 4, 30.0, 1'700'000'000.0}, Case{100.0, 2, 60.0}, Case{100.0, 4, 60.0}, Case{1000.0, 4, 32.0},
                           Case{1500.0, 4, 60.0}, Case{1500.0, 6, 60.0}, Case{60.0, 3, 30.0}, Case{75.0, 2, 30.0}, Case{89.0, 2, 30.0},
                           Case{120.0, 9, 5.0}, Case{1024.0, 4, 20.0}, Case{50.0, 2, 0.04}}) {
    const Table table = regular(each.rate_hz, static_cast<std::size_t>(each.rate_hz * each.seconds), each.decimals, each.begin_s);

    const auto series = table.even();

    ASSERT_TRUE(series);
    EXPECT_EQ(series->rate_hz, each.rate_hz) << each.decimals;
    EXPECT_EQ(series->flags, 0U) << each.rate_hz;
    EXPECT_EQ(series->ml_mm, table.ml_mm) << each.rate_hz;
    EXPECT_EQ(series->ap_mm, table.ap_mm);
    EXPECT_TRUE(series->load_n.empty());
  }
}

TEST(EvenSeries, RateThatIsNotWhole_IsKept) {
  struct Case {
    double rate_hz;
    std::size_t rows;
    int decimals;
    double tolerance_hz;
  };
  // The last: 399 steps of 80 Hz would end 1.25 units of the last decimal earlier.
  for (const Case& each :
       {Case{1500.0375, 90'000, 4, 1e-4}, Case{1500.0375, 90'000, 6, 1e-4}, Case{1500.0375, 90'000, 9, 1e-4}, Case{79.8, 400, 2, 0.02}}) {
    const auto series = regular(each.rate_hz, each.rows, each.decimals).even();

    ASSERT_TRUE(series);
    EXPECT_NEAR(series->rate_hz, each.rate_hz, each.tolerance_hz) << each.decimals;
    EXPECT_NE(series->rate_hz, std::round(series->rate_hz)) << each.decimals;
    EXPECT_EQ(series->flags, 0U) << each.decimals;
    EXPECT_EQ(series->ml_mm.size(), each.rows) << each.decimals;
  }
}

TEST(EvenSeries, RowsThatAreNotThere_AreMissingSamples) {
  Table table;
  for (std::size_t i = 0; i < 90'000; ++i) {
    if ((i >= 10 && i < 13) || (i >= 40'000 && i < 55'000)) continue;
    table.add(written(static_cast<double>(i) / 1500.0, 4));
  }

  const auto series = table.even();

  ASSERT_TRUE(series);
  EXPECT_EQ(series->rate_hz, 1500.0);
  ASSERT_EQ(series->ml_mm.size(), 90'000U);
  EXPECT_EQ(series->flags, 0U);
  for (const std::size_t i : {std::size_t{10}, std::size_t{12}, std::size_t{40'000}, std::size_t{54'999}}) {
    EXPECT_TRUE(std::isnan(series->ml_mm[i])) << i;
    EXPECT_TRUE(std::isnan(series->ap_mm[i])) << i;
  }
  EXPECT_EQ(series->ml_mm[9], table.ml_mm[9]);
  EXPECT_EQ(series->ml_mm[13], table.ml_mm[10]);
  EXPECT_EQ(series->ml_mm[55'000], table.ml_mm[39'997]);
  EXPECT_EQ(series->ml_mm.back(), table.ml_mm.back());
  EXPECT_EQ(regular(91.0, 910, 2).even()->rate_hz, 100.0) << "up to a tenth may be missing";
}

TEST(EvenSeries, EmptyCellsAndLoadsStayWhereTheyAre) {
  Table table = regular(50.0, 100, 2);
  table.ml_mm[7] = kNaN;
  const std::vector<double> load(100, 600.0);

  const auto series = even_series(table.t_s, table.ml_mm, table.ap_mm, load);

  ASSERT_TRUE(series);
  EXPECT_TRUE(std::isnan(series->ml_mm[7]));
  EXPECT_EQ(series->ap_mm[7], table.ap_mm[7]);
  EXPECT_EQ(series->load_n, load);
}

TEST(EvenSeries, SlightlyUneven_IsInterpolatedLinearly) {
  test::Noise noise(2);
  Table table;
  for (std::size_t i = 0; i < 2000; ++i) {
    if (i == 500) continue;
    table.add((static_cast<double>(i) + 0.16 * (noise.uniform() - 0.5)) / 100.0);
  }

  const auto series = table.even();

  ASSERT_TRUE(series);
  EXPECT_EQ(series->flags, sway_flag::kResampled);
  EXPECT_NEAR(series->rate_hz, 100.0, 0.001);
  ASSERT_EQ(series->ml_mm.size(), 2000U);
  std::size_t missing = 0;
  for (std::size_t i = 1; i + 1 < 2000; ++i) {
    if (std::isnan(series->ml_mm[i])) {
      ++missing;
      continue;
    }
    // Values at the grid, not of the row: a row is up to 0.8 ms off, where the sine moves by 2 mm/s.
    EXPECT_NEAR(series->ml_mm[i], Table::ml_at(static_cast<double>(i) / 100.0), 2.5e-4) << i;
  }
  EXPECT_EQ(missing, 1U);
}

TEST(EvenSeries, GridLiesInTheMiddleOfItsRows) {
  for (const double off_s : {-4e-4, 4e-4}) {
    Table table;
    for (int i = 0; i < 100; ++i) table.add(0.01 * i + (i == 50 ? off_s : 0.0));

    const auto series = table.even();

    ASSERT_TRUE(series);
    ASSERT_EQ(series->flags, sway_flag::kResampled);
    ASSERT_EQ(series->ap_mm.size(), 100U);
    for (std::size_t k = 1; k < 99; ++k) {
      EXPECT_NEAR(series->ap_mm[k], 1.0 - 2.0 * (0.01 * static_cast<double>(k) + 0.5 * off_s), 1e-9) << k;
    }
  }
}

TEST(EvenSeries, VeryUneven_IsAveragedOverWindows) {
  test::Noise noise(2);
  Table table;
  double t = 0.0;
  while (t < 30.0) {
    table.add(t);
    t += 0.004 + 0.012 * noise.uniform();
    if (table.t_s.size() == 700) t += 1.0;
  }

  const auto series = table.even();

  ASSERT_TRUE(series);
  EXPECT_EQ(series->flags, sway_flag::kWindowAveraged);
  EXPECT_NEAR(series->rate_hz, 100.0, 10.0);
  EXPECT_EQ(series->rate_hz, std::round(series->rate_hz));
  std::size_t missing = 0;
  for (std::size_t i = 1; i + 2 < series->ml_mm.size(); ++i) {
    const double at = static_cast<double>(i) / series->rate_hz;
    if (std::isnan(series->ap_mm[i])) {
      EXPECT_GT(at, table.t_s[699]);
      EXPECT_LT(at, table.t_s[700]);
      ++missing;
    } else if (at < table.t_s[699] - 0.02 || at > table.t_s[700] + 0.02) {
      EXPECT_NEAR(series->ap_mm[i], 1.0 - 2.0 * at, 0.02) << i;  // a window holds three rows at most 8 ms off its middle
    }
  }
  EXPECT_NEAR(static_cast<double>(missing) / series->rate_hz, 1.0, 0.07);
}

TEST(EvenSeries, AverageOfUnevenRows_WeighsThemByTheirTime) {
  // Rows every 0.1 s, and a crowd of five within 5 ms: it must not outweigh its neighbours.
  std::vector<double> t_s;
  std::vector<double> values;
  for (int i = 0; i <= 200; ++i) {
    t_s.push_back(0.1 * i);
    values.push_back(0.0);
    if (i != 100) continue;
    for (int crowd = 1; crowd <= 5; ++crowd) {
      t_s.push_back(10.0 + 0.001 * crowd);
      values.push_back(100.0);
    }
  }
  values.front() = 4.0;
  values.back() = 8.0;

  const auto series = even_series(t_s, values, values);

  ASSERT_TRUE(series);
  ASSERT_EQ(series->flags, sway_flag::kWindowAveraged);
  ASSERT_EQ(series->rate_hz, 10.0);
  // In the window 9.9 .. 10.1 the crowd holds from 10.0005 to half way to the next row at 10.1.
  EXPECT_NEAR(series->ml_mm[100], 100.0 * (10.0525 - 10.0005) / 0.2, 1e-9);
  EXPECT_EQ(series->ml_mm[98], 0.0);
  // The first and the last row hold for a step beyond the record, too: 0.15 of the 0.2 s that are known of their windows.
  EXPECT_NEAR(series->ml_mm.front(), 3.0, 1e-9);
  EXPECT_NEAR(series->ml_mm.back(), 6.0, 1e-9);
}

TEST(EvenSeries, SlowAndVeryUneven_HasOneSampleASecond) {
  test::Noise noise(2);
  std::vector<double> t_s = {0.0};
  while (t_s.size() < 60) t_s.push_back(t_s.back() + 2.0 + 4.0 * noise.uniform());

  const auto series = even_series(t_s, t_s, t_s);

  ASSERT_TRUE(series);
  EXPECT_EQ(series->flags, sway_flag::kWindowAveraged);
  EXPECT_EQ(series->rate_hz, 1.0);
}

TEST(EvenSeries, WhatIsNoSeriesIsRefused) {
  const auto refusal = [](const std::vector<double>& t_s, std::size_t ml, std::size_t ap, std::size_t load = 0) {
    const std::vector<double> values(100, 1.0);
    const std::span<const double> all(values);
    const auto series = even_series(t_s, all.first(ml), all.first(ap), all.first(load));
    if (series) return std::string();
    EXPECT_EQ(series.error().code, core::ErrorCode::InvalidArgument);
    return series.error().what + (series.error().hint.empty() ? "" : "; " + series.error().hint);
  };
  const std::vector<double> three{1.0, 2.0, 3.0};
  const std::string uneven = "the columns of the centre of pressure are not equally long";
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(three, 3, 3, 3), "");
  EXPECT_EQ(refusal(three, 3, 3, 0), "");
  EXPECT_EQ(refusal({}, 0, 0), "a centre of pressure of 0 rows: at least two are needed");
  EXPECT_EQ(refusal({1.0}, 1, 1), "a centre of pressure of 1 rows: at least two are needed");
  EXPECT_EQ(refusal(three, 2, 3), uneven);
  EXPECT_EQ(refusal(three, 3, 2), uneven);
  EXPECT_EQ(refusal(three, 3, 3, 2), uneven);
  EXPECT_EQ(refusal({1.0, 2.0, 2.0}, 3, 3), "the time of row 3 is not later than that of the row before");
  EXPECT_EQ(refusal({1.0, 0.5, 2.0}, 3, 3), "the time of row 2 is not later than that of the row before");
  EXPECT_EQ(refusal({1.0, kNaN, 2.0}, 3, 3), "the time of row 2 is not a number");
  EXPECT_EQ(refusal({0.0, 1.0, kInfinity}, 3, 3), "the time of row 3 is not a number");
  EXPECT_EQ(refusal({-1.7e308, 0.0, 1.7e308}, 3, 3), "the times are not valid times in seconds");
  EXPECT_EQ(refusal({0.0, 5e-324, 1e-323}, 3, 3), "the times are not valid times in seconds");
  for (const double hole_s : {1e5, 1e9, 1e30, 1e300})
    EXPECT_EQ(refusal({0.0, 0.001, 0.002, 0.003, 0.004, hole_s}, 6, 6),
              "6 rows over " + std::to_string(hole_s) + " s: the gaps are too long; cut the file at its longest gap")
        << hole_s;
}

TEST(SwayFlags, HaveNamesAndSentences) {
  using namespace sway_flag;
  EXPECT_TRUE(names_of(0).empty());
  EXPECT_EQ(names_of(kShortRecord | kCutAtGap | kDoubtful), (std::vector<std::string_view>{"short_record", "cut_at_gap", "doubtful"}));
  EXPECT_EQ(names_of(~0U).size(), kCount);
  for (std::uint32_t bit = 0; bit < kCount; ++bit) EXPECT_FALSE(sentence_of(1U << bit).empty()) << bit;
  EXPECT_TRUE(sentence_of(1U << kCount).empty());
  EXPECT_TRUE(sentence_of(0).empty());
}

}  // namespace
}  // namespace dts::posturography
