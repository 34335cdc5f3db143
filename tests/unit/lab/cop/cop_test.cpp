// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_estimator.h"

#include <sstream>

#include "lab/base/csv.h"
#include "lab/base/thesis_setup.h"
#include "physics/cop/cop_evaluation.h"
#include "physics/cop/sensed_plate.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::cop {
namespace {

using physics::CopMethod;
using ::testing::EndsWith;
using ::testing::HasSubstr;

const std::string kFloorRig = std::string(DTS_SOURCE_DIR) + "/config/rigs/floor-sim.toml";

class CopTest : public RunTest {
 protected:
  /// The samples that an estimator would be calibrated with, as a file.
  std::string points_file(CopMethod method, const std::string& header = "p_n,x_mm,y_mm,w1_mm,w2_mm,w3_mm,w4_mm") {
    const auto samples = physics::model_samples(method, thesis_setup::floor_platform(), physics::PlateBehaviour::Stiffening);
    sample_count_ = samples->size();
    std::ostringstream text;
    text.precision(15);
    text << header << '\n';
    for (const physics::CopSample& sample : *samples) {
      text << sample.load.value << ',' << sample.load_position.x.value << ',' << sample.load_position.y.value;
      for (const double deflection_mm : sample.deflection_mm) text << ',' << deflection_mm;
      text << '\n';
    }
    return write("points.csv", text.str());
  }
  /// Point loads of two weights on side x side places of the plate's middle; every third load is written down wrong by a part of it.
  std::string grid_file(int side, double wrong_part) {
    const auto plate = physics::SensedPlate::create(thesis_setup::floor_platform(), physics::PlateBehaviour::Stiffening);
    std::ostringstream text;
    text.precision(15);
    text << "p_n,x_mm,y_mm,w1_mm,w2_mm,w3_mm,w4_mm\n";
    for (int k = 0; k < 2 * side * side; ++k) {
      const double load_n = k % 2 == 0 ? 300.0 : 700.0;
      const physics::Point at{{86.0 + 258.0 * (k / 2 % side) / (side - 1)}, {86.0 + 258.0 * (k / 2 / side) / (side - 1)}};
      text << load_n * (k % 3 == 0 ? 1.0 + wrong_part : 1.0) << ',' << at.x.value << ',' << at.y.value;
      for (const double deflection_mm : plate->deflection_mm(at, {load_n})) text << ',' << deflection_mm;
      text << '\n';
    }
    return write("grid.csv", text.str());
  }
  CsvTable estimates() {
    files::Problems problems;
    CsvTable table = CsvTable::read(path("est.csv"),
                                    {{.name = "x_mm", .may_be_empty = true},
                                     {.name = "y_mm", .may_be_empty = true},
                                     {.name = "est_x_mm", .may_be_empty = true},
                                     {.name = "est_y_mm", .may_be_empty = true},
                                     {.name = "est_p_n", .may_be_empty = true},
                                     {.name = "flags", .is_text = true}},
                                    problems);
    EXPECT_TRUE(problems.empty());
    return table;
  }

  std::size_t sample_count_ = 0;  ///< Of the last points file.
};

TEST_F(CopTest, FitAndEstimate_FindTheCalibrationsOwnPoints) {
  const std::string points = points_file(CopMethod::Poly3);

  ASSERT_EQ(run_with({"cop", "fit", points, "--rig", kFloorRig, "--estimator", "poly3", "--out", path("cal.toml"), "--json"}), cli::kOk)
      << talk();
  EXPECT_LT(json().at("residuals").at("rms_total_mm").get<double>(), 0.3);
  EXPECT_EQ(json().at("points"), sample_count_);
  ASSERT_EQ(run_with({"cop", "estimate", path("cal.toml"), points, "--out", path("est.csv")}), cli::kOk) << talk();

  const CsvTable table = estimates();
  ASSERT_EQ(table.row_count(), sample_count_);
  EXPECT_THAT(table.header(), EndsWith("w4_mm,est_x_mm,est_y_mm,est_p_n,flags"));
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    EXPECT_NEAR(table.numbers("est_x_mm")[row], table.numbers("x_mm")[row], 1.0);
    EXPECT_NEAR(table.numbers("est_y_mm")[row], table.numbers("y_mm")[row], 1.0);
    EXPECT_EQ(table.texts("flags")[row], "");
  }
}

TEST_F(CopTest, EveryEstimatorOfTheContract_CanBeFitted) {
  for (const auto& [name, method] : {std::pair{"thesis", CopMethod::Thesis}, std::pair{"thesis_per_pair", CopMethod::ThesisPerPair}}) {
    EXPECT_EQ(run_with({"cop", "fit", points_file(method), "--rig", kFloorRig, "--estimator", name, "--out", path(name)}), cli::kOk)
        << talk();
    EXPECT_THAT(out(), HasSubstr("all 46 points"));
  }
}

TEST_F(CopTest, EstimateWithoutTruth_LeavesTheUndefinedEmpty) {
  ASSERT_EQ(run_with({"cop", "fit", points_file(CopMethod::Poly3), "--rig", kFloorRig, "--out", path("cal.toml")}), cli::kOk);
  const std::string bare = write("bare.csv", "note,w1_mm,w2_mm,w3_mm,w4_mm\nempty,0,0,0,0\n");

  ASSERT_EQ(run_with({"cop", "estimate", path("cal.toml"), bare, "--out", path("est.csv")}), cli::kOk) << talk();

  EXPECT_EQ(content("est.csv"), "note,w1_mm,w2_mm,w3_mm,w4_mm,est_x_mm,est_y_mm,est_p_n,flags\nempty,0,0,0,0,,,,no_contact\n");
  EXPECT_THAT(refusal_of({"cop", "estimate", path("cal.toml"), path("est.csv"), "--out", path("again.csv")}),
              HasSubstr("has estimates already"));
}

TEST_F(CopTest, BadPoints_ExitWithTwoAndPlace) {
  const std::string header = "p_n,x_mm,y_mm,w1_mm,w2_mm,w3_mm,w4_mm\n";
  for (const auto& [text, says] :
       {std::pair(header + "490,nan,86,1,1,1,1\n", "points.csv:2:5: x_mm: 'nan' is not a finite number\n"),
        {header + "490,430.1,86,1,1,1,1\n", "points.csv:2:5: x_mm = 430.1 is out of range; allowed: 0 .. 430\n"},
        {header + "490,430,86,1,1,1,1\n",
         "1 positions in 1 columns and 1 rows are too few for poly3\n  try: measure at least 4 x 4 positions, better 7 x 7\n"},
        {header.substr(4) + "86,86,1,1,1,1\n", "points.csv:1:1: column 'p_n' is missing\n"}}) {
    EXPECT_THAT(refusal_of({"cop", "fit", write("points.csv", text), "--rig", kFloorRig, "--out", path("cal.toml")}), EndsWith(says));
  }
  EXPECT_FALSE(std::filesystem::exists(path("cal.toml")));
}

TEST_F(CopTest, InputsAndCalibrations_AreNeverOverwritten) {
  const std::string points = points_file(CopMethod::Poly3);
  const std::string measured = content("points.csv");
  std::filesystem::create_symlink(points, path("link.csv"));

  for (const std::string& out : {points, path("link.csv"), path("./points.csv")}) {
    EXPECT_THAT(refusal_of({"cop", "fit", points, "--rig", kFloorRig, "--out", out}), HasSubstr("is the input file"));
  }
  ASSERT_EQ(run_with({"cop", "fit", points, "--rig", kFloorRig, "--out", path("cal.toml")}), cli::kOk) << talk();
  const std::string calibration = content("cal.toml");
  EXPECT_THAT(refusal_of({"cop", "fit", points, "--rig", kFloorRig, "--out", path("cal.toml")}),
              HasSubstr("a calibration is never overwritten"));
  for (const std::string& out : {points, path("cal.toml")}) {
    EXPECT_EQ(run_with({"cop", "estimate", path("cal.toml"), points, "--out", out}), cli::kUsage) << out;
  }
  EXPECT_EQ(content("points.csv"), measured);
  EXPECT_EQ(content("cal.toml"), calibration);

  EXPECT_EQ(run_with({"cop", "estimate", path("cal.toml"), points, "--out", path("est.csv")}), cli::kOk);
  EXPECT_EQ(run_with({"cop", "estimate", path("cal.toml"), points, "--out", path("est.csv")}), cli::kOk) << "estimates are made again";
}

TEST_F(CopTest, EstimateColumns_DoNotComeOutTwice) {
  ASSERT_EQ(run_with({"cop", "fit", points_file(CopMethod::Poly3), "--rig", kFloorRig, "--out", path("cal.toml")}), cli::kOk);

  for (const char* column : {"flags", "est_p_n", "est_y_mm", "est_x_mm"}) {
    const std::string text = "w1_mm,w2_mm,w3_mm,w4_mm," + std::string(column) + "\n1,1,1,1,0\n";
    EXPECT_THAT(refusal_of({"cop", "estimate", path("cal.toml"), write("bare.csv", text), "--out", path("est.csv")}),
                HasSubstr("has estimates already (column '" + std::string(column) + "')"));
  }
}

TEST_F(CopTest, CoarseGridsAndWrongLoads_AreWarnedOf) {
  const auto fit = [&](int side, double wrong_part, const std::string& name) {
    return run_with({"cop", "fit", grid_file(side, wrong_part), "--rig", kFloorRig, "--out", path(name)});
  };

  ASSERT_EQ(fit(5, 0.0, "5.toml"), cli::kOk) << talk();
  EXPECT_THAT(talk(), HasSubstr("6 x 6 positions or more"));
  ASSERT_EQ(fit(8, 0.0, "8.toml"), cli::kOk) << talk();
  EXPECT_EQ(talk(), "");
  ASSERT_EQ(fit(8, 0.2, "wrong.toml"), cli::kOk) << talk();
  EXPECT_THAT(talk(), HasSubstr("check the loads"));
}

TEST_F(CopTest, BadCalibration_ExitsWithTwo) {
  const std::string points = write("bare.csv", "w1_mm,w2_mm,w3_mm,w4_mm\n1,1,1,1\n");

  EXPECT_EQ(run_with({"cop", "estimate", write("cal.toml", "format = 1\n"), points, "--out", path("est.csv")}), cli::kUsage);
  EXPECT_EQ(run_with({"cop", "estimate", path("none.toml"), points, "--out", path("est.csv")}), cli::kUsage);
  EXPECT_FALSE(std::filesystem::exists(path("est.csv")));
}

// Research sheet section 6: thesis pair averages 1.25 mm bias and 1.30 noisy over the sensor square on the linear plate.
TEST_F(CopTest, EvaluateJson_HasTheStudysFigures) {
  ASSERT_EQ(run_with({"cop", "evaluate", "--estimator", "thesis", "--linear", "--json"}), cli::kOk);
  EXPECT_NEAR(json().at("rms_total_mm").get<double>(), 1.25, 0.07);
  EXPECT_EQ(json().at("map").size(), 33U * 33U);

  ASSERT_EQ(run_with({"cop", "evaluate", "--estimator", "thesis", "--linear", "--noise", "realistic", "--json"}), cli::kOk);
  EXPECT_NEAR(json().at("rms_total_mm").get<double>(), 1.30, 0.07);

  ASSERT_EQ(run_with({"cop", "evaluate", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("estimator"), "poly3");
  EXPECT_LT(json().at("rms_total_mm").get<double>(), 0.3);
}

TEST_F(CopTest, Evaluate_TakesRigLoadsAndContact) {
  EXPECT_EQ(run_with({"cop", "evaluate", "--rig", kFloorRig, "--loads", "240", "490"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("240 N, sensor square"));
  EXPECT_THAT(out(), HasSubstr("490 N, central 200 mm"));
  EXPECT_THAT(out(), HasSubstr("Error (mm) under 240 N"));

  EXPECT_EQ(run_with({"cop", "evaluate", "--contact", "two-feet", "--linear", "--json"}), cli::kOk);
  EXPECT_NEAR(json().at("rms_total_mm").get<double>(), 4.3, 1.0) << "research sheet section 6: 4-4.6 mm";
  EXPECT_EQ(run_with({"cop", "evaluate", "--estimator", "moment"}), cli::kUsage) << "needs more sensors";
}

}  // namespace
}  // namespace dts::lab::cop
