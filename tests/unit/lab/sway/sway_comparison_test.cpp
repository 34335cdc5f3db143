// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_comparison.h"

#include "unit/lab/sway/sway_files.h"

namespace dts::lab::sway {
namespace {

using ::testing::HasSubstr;

class SwayComparisonTest : public RunTest {};

TEST_F(SwayComparisonTest, EyesOpenAndClosed_GiveRombergQuotients) {
  const std::string open = write("open.csv", made::circle(2000, 10.0));
  const std::string closed = write("closed.csv", made::circle(2000, 15.0));

  ASSERT_EQ(run_with({"sway", open, closed, "--compare", "--label", "eyes=open,closed", "--profile", "asis", "--json"}), cli::kOk)
      << talk();

  const auto comparison = json().at("comparison");
  EXPECT_NEAR(comparison.at("measures").at("RDIST").at("difference").get<double>(), 5.0, 1e-9);
  EXPECT_NEAR(comparison.at("measures").at("RDIST").at("percent").get<double>(), 50.0, 1e-9);
  EXPECT_NEAR(comparison.at("romberg").at("RDIST").get<double>(), 1.5, 1e-9);
  EXPECT_NEAR(comparison.at("romberg").at("PEA95_F").get<double>(), 2.25, 1e-9);
  EXPECT_EQ(talk(), "");

  ASSERT_EQ(run_with({"sway", closed, open, "--compare", "--label", "eyes=closed,open", "--profile", "asis", "--json"}), cli::kOk);
  EXPECT_NEAR(json().at("comparison").at("romberg").at("RDIST").get<double>(), 1.5, 1e-9) << "closed / open, in whatever order";
  ASSERT_EQ(run_with({"sway", open, closed, "--compare", "--label", "eyes=open,closed"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("ROMBERG"));
}

TEST_F(SwayComparisonTest, WhatDoesNotCompare_IsWarnedOfAndHasNoQuotient) {
  const std::string open = write("open.csv", made::circle(2000));
  const std::string longer = write("longer.csv", made::circle(2500));

  ASSERT_EQ(run_with({"sway", open, longer, "--compare", "--label", "eyes=open,closed", "--json"}), cli::kOk) << talk();
  EXPECT_THAT(talk(), HasSubstr("durations differ (20 and 25 s)"));
  EXPECT_FALSE(json().at("comparison").contains("romberg"));
  ASSERT_EQ(run_with({"sway", open, open, "--compare", "--label", "eyes=open,closed", "--label", "surface=firm,foam", "--json"}), cli::kOk);
  EXPECT_FALSE(json().at("comparison").contains("romberg")) << "another surface";
  ASSERT_EQ(run_with({"sway", open, open, "--compare", "--label", "eyes=open,closed", "--label", "feedback=cop,", "--json"}), cli::kOk);
  EXPECT_FALSE(json().at("comparison").contains("romberg")) << "one with feedback";
  EXPECT_THAT(talk(), HasSubstr("only one of the trials has feedback"));
  ASSERT_EQ(run_with({"sway", open, open, "--compare", "--json"}), cli::kOk);
  EXPECT_FALSE(json().at("comparison").contains("romberg")) << "nothing is said of the eyes";
}

MeasuredTrial measured(double rate_hz, std::size_t samples, double angle_deg) {
  MeasuredTrial trial{.file = "a.csv"};
  trial.analysis = posturography::Analysis{.rate_hz = rate_hz, .samples = samples, .duration_s = static_cast<double>(samples) / rate_hz};
  trial.analysis->measures.set(posturography::Measure::EllAngle, angle_deg);
  trial.analysis->measures.set(posturography::Measure::Mvelo, 0.0);
  return trial;
}

TEST(SwayComparison, RatesAndInvalidTrials_AreWarnedOf) {
  const MeasuredTrial first = measured(100.0, 3000, 10.0);
  MeasuredTrial second = measured(1000.0, 30000, 20.0);
  second.analysis->flags = posturography::sway_flag::kSteppedOff;

  const Comparison comparison = compare(first, second);

  ASSERT_EQ(comparison.warnings.size(), 2U);
  EXPECT_THAT(comparison.warnings[0], HasSubstr("stepped off"));
  EXPECT_THAT(comparison.warnings[1], HasSubstr("rates differ (100 and 1000 Hz)"));
}

TEST(SwayComparison, PercentOfZeroIsNotDefined) {
  const Comparison comparison = compare(measured(100.0, 3000, 10.0), measured(100.0, 3000, 20.0));

  for (const ComparedMeasure& compared : comparison.measures) EXPECT_FALSE(compared.percent.has_value());
  EXPECT_FALSE(comparison.measures.empty());
}

}  // namespace
}  // namespace dts::lab::sway
