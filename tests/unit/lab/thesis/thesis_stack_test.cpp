// SPDX-License-Identifier: Apache-2.0
// Thesis table 4.2: the simulated platform on the simulated force plate, through the stages of both.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "lab/thesis/printed.h"
#include "lab/thesis/stack_trials.h"
#include "lab/thesis/thesis.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::thesis {
namespace {

double value_of(const Figures& figures, std::string_view name) {
  const auto found = std::ranges::find(figures, name, &Figure::name);
  EXPECT_NE(found, figures.end()) << name;
  return found == figures.end() ? std::nan("") : found->value;
}

TEST(PrintedTable42, TwentyValues_HaveThePrintedMean) {
  double sum = 0.0;
  for (const auto* rows : {&printed::kTwoFeetRmse, &printed::kOneFootRmse}) {
    for (const printed::PlateRmse& row : *rows) sum += row.x_mm + row.y_mm;
  }
  EXPECT_NEAR(sum / 20.0, printed::kMeanPlateRmseMm, 0.005);
}

TEST(ThesisStack, MeanRemoved_WithinTheIssuesLimitsAndRawReportedAsItIs) {
  RecordProperty("requirement", "COP-11");
  const auto table = thesis_table("4.2");
  ASSERT_TRUE(table) << core::to_string(table.error());

  ASSERT_EQ(table->rows.size(), 10U);
  EXPECT_EQ(value_of(table->rows[6].printed, "y_mm"), 2.8);
  for (std::size_t row = 0; row < table->rows.size(); ++row) {
    const ThesisRow& of = table->rows[row];
    const double limit_mm = row < 5 ? 0.6 : 1.0;
    for (const std::string axis : {"x", "y"}) {
      const double removed_mm = value_of(of.ours, "mean_removed_" + axis + "_mm");
      EXPECT_GT(removed_mm, 0.01) << of.label;  // two devices with noise of their own
      EXPECT_LE(removed_mm, limit_mm) << of.label << " " << axis;
      EXPECT_GE(value_of(of.ours, "raw_" + axis + "_mm"), removed_mm) << of.label;
    }
  }
  // The offset on two feet is that of a calibration with point loads: it is there, and not tuned away.
  EXPECT_GT(value_of(table->summary, "two_feet_largest_raw_mm"), 1.0);
  EXPECT_NE(table->figures.find("multiplot"), std::string::npos);
}

TEST(ThesisStack, Comparison_SeparatesOffsetAndRest) {
  StackTrial::Axis axis;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.01 * i;
    axis.plate_mm.push_back(10.0 * t);
    axis.floor_mm.push_back(10.0 * t + 3.0 + (i % 2 == 0 ? 0.4 : -0.4));
  }
  const AxisComparison found = compare(axis);
  EXPECT_NEAR(found.raw_mm, std::hypot(3.0, 0.4), 1e-9);
  EXPECT_NEAR(found.mean_removed_mm, 0.4, 1e-9);
  EXPECT_NEAR(found.moved_in_50_ms_mm, 0.5, 1e-9);
}

TEST_F(RunTest, ThesisPlot_OnlyOfATableWithFiguresAndBeforeComputing) {
  EXPECT_NE(run_with({"thesis", "3.4", "--plot", path("loci.svg")}), cli::kOk);
  EXPECT_THAT(talk(), ::testing::HasSubstr("table 3.4 has no figures to draw"));
  EXPECT_NE(run_with({"thesis", "4.2", "--plot", path("loci.pdf")}), cli::kOk);
  EXPECT_FALSE(std::filesystem::exists(path("loci.pdf")));
}

TEST_F(RunTest, ThesisPlot_DrawsEightPanels) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_EQ(run_with({"thesis", "4.2", "--plot", path("loci.svg")}), cli::kOk) << talk();

  const std::string svg = content("loci.svg");
  for (const char* title :
       {"4.11: V3, two feet, COP x", "4.11: V3, two feet, COP y", "4.12: V4, one foot, COP x", "4.12: V4, one foot, COP y",
        "4.13: V4, two feet", "4.13: V3, one foot", "4.13: V4, one foot", "4.13: V5, one foot"}) {
    EXPECT_THAT(svg, ::testing::HasSubstr(title));
  }
}

}  // namespace
}  // namespace dts::lab::thesis
