// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/compare.h"

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "unit/lab/compare/made_recordings.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::compare {
namespace {

using ::testing::HasSubstr;

TEST(Compare, SameSignalAtOtherRateAndClock_OffsetAndDriftAreFound) {
  const Recording a = recorded({.length_s = 60.0});
  const Clock clock{.first_s = 100.0, .offset_s = -93.7126, .drift_ppm = 80.0, .rate_hz = 64.0, .length_s = 45.0};

  const auto comparison = compare(a, recorded(clock));

  ASSERT_TRUE(comparison) << comparison.error().what;
  const Alignment& alignment = comparison->alignment;
  EXPECT_EQ(alignment.means, Alignment::Means::Correlation);
  EXPECT_NEAR(alignment.offset_s, offset_at(clock, alignment.reference_s), 1e-4);
  EXPECT_NEAR(alignment.drift_ppm, 80.0, 5.0);
  EXPECT_GT(alignment.peak_correlation, 0.99);
  EXPECT_LT(comparison->rmse_total_mm, 0.01);
  EXPECT_NEAR(comparison->overlap_s, 45.0, 0.1);
  EXPECT_NEAR(static_cast<double>(comparison->scan_count), 45.0 * 64.0, 2.0);
}

TEST(Compare, NoiseGainAndShift_UncertaintyCoversTheError) {
  const Recording a = recorded({.length_s = 60.0}, 0.2);
  const Clock clock{.offset_s = 4.0321, .drift_ppm = -150.0, .rate_hz = 100.0, .length_s = 50.0};

  const auto comparison = compare(a, recorded(clock, 0.3, 0.92, 5.0));

  ASSERT_TRUE(comparison) << comparison.error().what;
  const Alignment& alignment = comparison->alignment;
  EXPECT_LT(std::abs(alignment.offset_s - offset_at(clock, alignment.reference_s)), 4.0 * alignment.offset_sd_s);
  EXPECT_LT(std::abs(alignment.drift_ppm + 150.0), 4.0 * alignment.drift_sd_ppm);
  EXPECT_LT(alignment.offset_sd_s, 0.005);
  EXPECT_NEAR(comparison->x.mean_difference_mm, 5.0, 0.2);
  EXPECT_NEAR(comparison->y.mean_difference_mm, -5.0, 0.2);
  EXPECT_GT(comparison->x.rmse_mm, 4.8);
  EXPECT_LT(comparison->x.rmse_mean_removed_mm, 0.8);
  EXPECT_NEAR(comparison->rmse_total_mm, std::hypot(comparison->x.rmse_mm, comparison->y.rmse_mm), 1e-12);
}

TEST(Compare, Itself_IsNoDifferenceAndCertain) {
  const Recording a = recorded({});

  const auto comparison = compare(a, a);

  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->alignment.offset_s, 0.0, 1e-9);
  EXPECT_LT(comparison->alignment.offset_sd_s, 1e-9);
  EXPECT_EQ(comparison->scan_count, a.t_s.size());
  EXPECT_NEAR(comparison->rmse_total_mm, 0.0, 1e-6);
}

TEST(Compare, OtherWayRound_TheOffsetChangesSign) {
  const Recording a = recorded({});
  const Recording b = recorded({.offset_s = 2.5, .rate_hz = 50.0, .length_s = 20.0});

  const auto forth = compare(a, b);
  const auto back = compare(b, a);

  ASSERT_TRUE(forth);
  ASSERT_TRUE(back);
  EXPECT_NEAR(forth->alignment.offset_s, 2.5, 1e-4);
  EXPECT_NEAR(back->alignment.offset_s, -2.5, 1e-3);
  EXPECT_NEAR(forth->x.rmse_mm, back->x.rmse_mm, 1e-3);
}

// A known difference: sine against the same with 10 % less gain. RMSE 0.1 * amplitude / sqrt 2, whole periods.
TEST(Compare, KnownDifference_HasItsRmseAndLargestValue) {
  Recording a;
  for (int k = 0; k <= 2000; ++k) {
    a.t_s.push_back(0.01 * k);
    a.x_mm.push_back(10.0 * std::sin(2.0 * std::numbers::pi * 0.3 * a.t_s.back()) + 0.2 * a.t_s.back());
    a.y_mm.push_back(a.t_s.back() * a.t_s.back() / 40.0);
  }
  Recording b = a;
  for (std::size_t k = 0; k < b.t_s.size(); ++k) {
    b.x_mm[k] += std::sin(2.0 * std::numbers::pi * 0.3 * b.t_s[k]);
    b.y_mm[k] += 3.0;
  }

  const auto comparison = compare(a, b);

  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->x.rmse_mm, 1.0 / std::numbers::sqrt2, 0.05);
  EXPECT_NEAR(comparison->x.largest_mm, 1.0, 0.1);
  EXPECT_NEAR(comparison->y.rmse_mm, 3.0, 0.05);
  EXPECT_NEAR(comparison->y.rmse_mean_removed_mm, 0.0, 0.05);
  EXPECT_NEAR(comparison->x.upper_limit_mm - comparison->x.mean_difference_mm, 1.96 * comparison->x.rmse_mean_removed_mm, 1e-3);
  EXPECT_NEAR(comparison->x.lower_limit_mm, -1.96 / std::numbers::sqrt2, 0.1);
  EXPECT_NEAR(comparison->y.lower_limit_mm, 3.0, 0.1);
  EXPECT_NEAR(comparison->y.upper_limit_mm, 3.0, 0.1);
}

TEST(Compare, OneTrigger_GivesAnOffsetAndNoDrift) {
  const Clock clock_b{.offset_s = 3.0};
  Recording a = recorded({});
  Recording b = recorded(clock_b);
  add_triggers(a, {}, {10.0});
  add_triggers(b, clock_b, {10.0});

  const auto comparison = compare(a, b);

  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->alignment.offset_s, 3.0, 0.011);
  EXPECT_NEAR(comparison->alignment.offset_sd_s, 0.01 / std::sqrt(6.0), 1e-4);
  EXPECT_TRUE(std::isnan(comparison->alignment.drift_ppm));
}

TEST(Compare, TimesSince1970_AlignAsFineAsOthers) {
  Recording a = recorded({.length_s = 40.0});
  const Clock clock{.offset_s = 3.4567, .drift_ppm = 40.0, .rate_hz = 90.0, .length_s = 35.0};
  Recording b = recorded(clock);
  a.began_s = 1.7e9;
  b.began_s = 1.7e9 - 250.0;

  const auto comparison = compare(a, b);

  ASSERT_TRUE(comparison) << comparison.error().what;
  const Alignment& alignment = comparison->alignment;
  EXPECT_NEAR(alignment.offset_s, 250.0 + offset_at(clock, alignment.reference_s - b.began_s), 1e-4);
  EXPECT_NEAR(alignment.reference_s, b.began_s + 17.5, 1.0);
}

TEST(Compare, UnlikeRecordings_AreRefused) {
  const Recording a = recorded({});
  Recording b = a;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  for (std::size_t k = 0; k < b.t_s.size(); ++k) {
    b.x_mm[k] = noise(random);
    b.y_mm[k] = noise(random);
  }

  const auto comparison = compare(a, b);

  ASSERT_FALSE(comparison);
  EXPECT_EQ(comparison.error().code, core::ErrorCode::Failed);
  EXPECT_THAT(comparison.error().hint, HasSubstr("trigger"));
}

TEST(Compare, MissingScans_AreNeitherInterpolatedNorCounted) {
  const Recording a = recorded({});
  Recording b = recorded({.offset_s = 1.0, .length_s = 20.0});
  for (std::size_t k = 500; k < 700; ++k) b.x_mm[k] = std::nan("");

  const auto comparison = compare(a, b);

  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->scan_count, 1800U);
  EXPECT_NEAR(comparison->alignment.offset_s, 1.0, 1e-4);
  EXPECT_LT(comparison->rmse_total_mm, 1e-3);
}

TEST(SmoothSeries, BetweenSamplesSmooth_InHolesAndOutsideUndefined) {
  std::vector<double> t_s;
  std::vector<double> values;
  for (int k = 0; k < 100; ++k) {
    if (k >= 50 && k < 60) continue;
    t_s.push_back(0.1 * k);
    values.push_back(std::sin(0.1 * k));
  }
  const SmoothSeries series(t_s, values);

  EXPECT_NEAR(series.at(2.345).value, std::sin(2.345), 1e-4);
  EXPECT_NEAR(series.at(2.345).slope_per_s, std::cos(2.345), 5e-3);
  EXPECT_TRUE(std::isnan(series.at(5.5).value));
  EXPECT_TRUE(std::isnan(series.at(-0.01).value));
  EXPECT_TRUE(std::isnan(series.at(9.91).value));
}

std::string csv_of(const Recording& recording) {
  std::ostringstream text;
  text.precision(16);
  text << "t_s,x_mm,y_mm\n";
  for (std::size_t k = 0; k < recording.t_s.size(); ++k)
    text << recording.t_s[k] << ',' << recording.x_mm[k] << ',' << recording.y_mm[k] << '\n';
  return text.str();
}

TEST_F(RunTest, CompareJson_NamesOffsetDriftAndErrors) {
  const std::string a = write("a.csv", csv_of(recorded({})));
  const std::string b = write("b.csv", csv_of(recorded({.offset_s = 2.0, .rate_hz = 80.0, .length_s = 20.0})));

  EXPECT_EQ(run_with({"compare", a, b, "--json"}), cli::kOk);

  EXPECT_NEAR(json().at("alignment").at("offset_s").get<double>(), 2.0, 1e-3);
  EXPECT_EQ(json().at("alignment").at("by"), "correlation");
  EXPECT_TRUE(json().at("alignment").contains("drift_sd_ppm"));
  EXPECT_LT(json().at("x").at("rmse_mm").get<double>(), 0.01);

  EXPECT_EQ(run_with({"compare", a, b}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("aligned by correlation"));
}

TEST_F(RunTest, CompareWithUnixTimes_TellsTheOffsetOfTheClocks) {
  Recording since_1970 = recorded({.length_s = 40.0}, 0.2);
  for (double& t_s : since_1970.t_s) t_s += 1.7e9;
  const std::string a = write("a.csv", csv_of(since_1970));
  const std::string b = write("b.csv", csv_of(recorded({.first_s = 5.0, .rate_hz = 90.0, .length_s = 30.0}, 0.3)));

  ASSERT_EQ(run_with({"compare", a, b, "--json"}), cli::kOk) << talk();

  EXPECT_NEAR(json().at("alignment").at("offset_s").get<double>(), 1.7e9, 0.01);
  EXPECT_NEAR(json().at("alignment").at("reference_s").get<double>(), 20.0, 0.1);
  ASSERT_EQ(run_with({"compare", a, a, "--json"}), cli::kOk) << talk();
  EXPECT_NEAR(json().at("alignment").at("offset_s").get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(json().at("alignment").at("reference_s").get<double>(), 1.7e9 + 20.0, 0.1);
}

TEST_F(RunTest, CompareOpposedSignals_AreWarnedOf) {
  Recording a = recorded({});
  Recording b = a;
  for (double& x : b.x_mm) x = -x;
  for (double& y : b.y_mm) y = -y;
  const auto with_triggers = [](const Recording& recording) {
    std::istringstream rows(csv_of(recording));
    std::string text;
    int row = 0;
    for (std::string line; std::getline(rows, line); ++row) {
      text += line + (row == 0 ? ",trigger" : row == 300 || row == 900 || row == 2000 ? ",5" : ",0") + "\n";
    }
    return text;
  };

  EXPECT_EQ(run_with({"compare", write("a.csv", with_triggers(a)), write("b.csv", with_triggers(b))}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("aligned by trigger (3 events)"));
  EXPECT_THAT(talk(), HasSubstr("the recordings do not agree: correlation -1.00"));
}

TEST_F(RunTest, CompareExportedTable_ColumnsOfTheExportAreKnown) {
  const Recording a = recorded({});
  std::string exported = csv_of(a);
  exported.replace(0, exported.find('\n'), "t_s,ml_mm,ap_mm");

  ASSERT_EQ(run_with({"compare", write("a.csv", csv_of(a)), write("b.csv", exported), "--json"}), cli::kOk) << talk();

  EXPECT_NEAR(json().at("rmse_total_mm").get<double>(), 0.0, 1e-9);
  EXPECT_EQ(run_with({"compare", "a.csv", write("c.csv", "t_s,up_mm\n0,1\n")}), cli::kUsage);
}

TEST_F(RunTest, ReadRecording_OnlyAGapOffTheGridIsARestartOfTheClock) {
  const auto restarts = [&](double gap_s) {
    Recording recording = recorded({.length_s = 4.0});
    for (std::size_t k = 200; k < recording.t_s.size(); ++k) recording.t_s[k] += gap_s;
    files::Problems problems;
    return read_recording(write("gap.csv", csv_of(recording)), {}, problems).restarts_s;
  };

  EXPECT_THAT(restarts(0.5), ::testing::IsEmpty()) << "50 scans are missing";
  EXPECT_THAT(restarts(0.504), ::testing::ElementsAre(::testing::DoubleNear(2.504, 1e-9)));
  EXPECT_THAT(restarts(0.004), ::testing::IsEmpty()) << "no gap";
}

TEST_F(RunTest, CompareTimesRoundedToMilliseconds_AreOnTheirGrid) {
  const auto restarts = [&](double jump_s) {
    Recording recording = recorded({.rate_hz = 60.0, .length_s = 60.0});
    Recording cut;
    for (std::size_t k = 0; k < recording.t_s.size(); ++k) {
      if (k >= 600 && k < 3000) continue;
      cut.t_s.push_back(std::round(1e3 * (recording.t_s[k] + (k < 600 ? 0.0 : jump_s))) / 1e3);
      cut.x_mm.push_back(recording.x_mm[k]);
      cut.y_mm.push_back(recording.y_mm[k]);
    }
    files::Problems problems;
    return read_recording(write("rounded.csv", csv_of(cut)), {}, problems).restarts_s;
  };

  EXPECT_THAT(restarts(0.0), ::testing::IsEmpty());
  EXPECT_THAT(restarts(0.408), ::testing::SizeIs(1)) << "half a scan off";
}

TEST_F(RunTest, CompareBadFiles_ExitWithTwo) {
  const std::string good = write("a.csv", csv_of(recorded({})));
  const std::string back = write("b.csv", "t_s,x_mm,y_mm\n0,1,1\n0,2,2\n");

  EXPECT_THAT(refusal_of({"compare", good, back}), HasSubstr("b.csv:3:1: t_s does not increase"));
  EXPECT_THAT(refusal_of({"compare", good, write("c.csv", "t_s,x_mm,y_mm\n0,1,1\n1,2,2\n")}), HasSubstr("at least 20 scans over 2 s"));
  EXPECT_THAT(refusal_of({"compare", good, "session.xdf"}), HasSubstr("cannot open session.xdf"));
}

}  // namespace
}  // namespace dts::lab::compare
