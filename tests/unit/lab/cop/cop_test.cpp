// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_estimator.h"

#include <sstream>

#include "files/cop_calibration_file.h"
#include "lab/base/csv.h"
#include "lab/base/thesis_setup.h"
#include "physics/cop/cop_evaluation.h"
#include "physics/cop/sensed_plate.h"
#include "unit/lab/run_fixture.h"
#include "unit/physics/cop/constant_two_feet.h"

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

TEST_F(CopTest, Fit_NamesTheDaqOfTheTable) {
  const std::string points = points_file(CopMethod::Poly3);
  const std::vector<std::string> fit{"cop", "fit", points, "--rig", kFloorRig, "--out", path("cal.toml")};
  const auto with = [&fit](std::vector<std::string> more) {
    more.insert(more.begin(), fit.begin(), fit.end());
    return more;
  };
  EXPECT_THAT(refusal_of(with({"--daq-serial", "01A2B3C4"})), HasSubstr("--daq-serial requires --daq-model"));
  EXPECT_THAT(refusal_of(with({"--daq-model", std::string(201, 'x')})), HasSubstr("longer than 200 characters"));

  ASSERT_EQ(run_with(with({"--daq-model", "USB-6008", "--daq-serial", "01A2B3C4"})), cli::kOk) << talk();

  files::Problems problems;
  const auto calibration = files::read_cop_calibration(path("cal.toml"), problems);
  ASSERT_TRUE(calibration);
  EXPECT_EQ(calibration->origin.daq_model, "USB-6008");
  EXPECT_EQ(calibration->origin.daq_serial, "01A2B3C4");
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

/// 2 mm to the right, 3 mm back, 10 % more load; without the width 20 %.
std::string constant_correction(const std::string& file) {
  const auto samples =
      physics::model_samples(CopMethod::Poly3, thesis_setup::floor_platform(), physics::PlateBehaviour::Stiffening).value();
  auto calibration = physics::calibrate_cop(CopMethod::Poly3, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
  calibration.two_feet = physics::TwoFeetCorrection::from_form(physics::test::constant_form()).value();
  EXPECT_TRUE(files::write_cop_calibration(file, calibration));
  return file;
}

TEST_F(CopTest, Estimate_CorrectsPeopleButNoPoints) {
  const auto plate = physics::SensedPlate::create(thesis_setup::floor_platform(), physics::PlateBehaviour::Stiffening);
  std::ostringstream w;
  for (const double deflection_mm : plate->deflection_mm({{215.0}, {215.0}}, {600.0})) w << ',' << deflection_mm;
  const std::string points =
      write("people.csv",
            "person,stated_width_mm,stated_weight_n,w1_mm,w2_mm,w3_mm,w4_mm\n,,"
            "" + w.str() +
                "\nP1,200,655" + w.str() + "\nP1,," + w.str() + "\nP2,,600" + w.str() + "\n,200," + w.str() + "\nP3,500," + w.str() + "\n");

  ASSERT_EQ(run_with({"cop", "estimate", constant_correction(path("cal.toml")), points, "--out", path("est.csv")}), cli::kOk) << talk();

  files::Problems problems;
  const CsvTable table =
      CsvTable::read(path("est.csv"), {{.name = "est_x_mm"}, {.name = "est_p_n"}, {.name = "flags", .is_text = true}}, problems);
  ASSERT_EQ(table.row_count(), 6U);
  const auto& load_n = table.numbers("est_p_n");
  EXPECT_NEAR(load_n[0], 600.0, 6.0) << "a point load";
  EXPECT_NEAR(load_n[1] / load_n[0], 1.1, 1e-6);
  EXPECT_NEAR(load_n[2] / load_n[0], 1.1, 1e-6) << "the width is that of the person";
  EXPECT_NEAR(load_n[3] / load_n[0], 1.2, 1e-6);
  EXPECT_NEAR(load_n[4] / load_n[0], 1.1, 1e-6) << "a person without a name";
  EXPECT_NEAR(table.numbers("est_x_mm")[1] - table.numbers("est_x_mm")[0], 2.0, 1e-6);
  EXPECT_THAT(table.texts("flags"), ::testing::ElementsAre("", "", "", "about|doubtful", "", "outside_two_feet"));
  EXPECT_THAT(talk(), HasSubstr("person 'P2': stated width or weight is doubtful"));
  EXPECT_THAT(talk(), ::testing::Not(HasSubstr("P1")));
}

TEST_F(CopTest, EstimateBeyondTheSensors_IsSaid) {
  const std::string points = write("deep.csv", "person,w1_mm,w2_mm,w3_mm,w4_mm\nP1,5.2,5.1,5,5\nP1,4.9,4.9,4.9,4.9\n");

  ASSERT_EQ(run_with({"cop", "estimate", constant_correction(path("cal.toml")), points, "--out", path("est.csv")}), cli::kOk) << talk();

  EXPECT_THAT(content("est.csv"), HasSubstr("outside_travel"));
  EXPECT_THAT(talk(), HasSubstr("1 rows have a deflection above 5.0 mm: the sensors do not measure that far"));
}

TEST_F(CopTest, CalibrationWithoutTheCorrection_IgnoresThePeople) {
  ASSERT_EQ(run_with({"cop", "fit", points_file(CopMethod::Poly3), "--rig", kFloorRig, "--out", path("cal.toml")}), cli::kOk);
  const std::string points = write("people.csv", "person,stated_width_mm,w1_mm,w2_mm,w3_mm,w4_mm\nP1,200,2,2,2,2\n");

  ASSERT_EQ(run_with({"cop", "estimate", path("cal.toml"), points, "--out", path("est.csv")}), cli::kOk) << talk();

  EXPECT_THAT(content("est.csv"), EndsWith(",\n")) << "no flags";
}

TEST_F(CopTest, TwoFeet_WritesACalibrationOfTheRig) {
  const std::string curve = std::string(DTS_SOURCE_DIR) + "/config/sensors/hoa1405-assumed.toml";
  std::string rig =
      "[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = 3.0\ne_pa = 198.7e9\nnu = 0.27\n[support]\nkind = \"corner\"\ninset_mm = 10.75\n";
  for (const char* at : {"x_mm = 86\ny_mm = 86", "x_mm = 344\ny_mm = 86", "x_mm = 86\ny_mm = 344", "x_mm = 344\ny_mm = 344"}) {
    rig += "[[sensor]]\nlabel = \"" + std::to_string(rig.size()) + "\"\n" + std::string(at) + "\ncurve = \"" + curve + "\"\n";
  }
  const std::string bare = write("rig.toml", rig + "[[stage]]\nid = \"cop\"\nestimator = \"thesis\"\n");
  ASSERT_EQ(run_with({"cop", "two-feet", "--rig", bare, "--out", path("cal.toml"), "--json"}), cli::kOk) << talk();

  EXPECT_EQ(json().at("on_top_of"), "plate_model");
  EXPECT_THAT(json().at("id").get<std::string>(), EndsWith("-two-feet"));
  EXPECT_EQ(json().at("travel_mm"), 5.0);
  EXPECT_NEAR(json().at("too_heavy_kg").get<double>(), 80.0, 10.0);
  files::Problems problems;
  const auto calibration = files::read_cop_calibration(path("cal.toml"), problems);
  ASSERT_TRUE(calibration);
  EXPECT_TRUE(calibration->two_feet);
  EXPECT_EQ(calibration->estimator.method(), CopMethod::Thesis);
  EXPECT_THAT(refusal_of({"cop", "two-feet", "--rig", kFloorRig, "--out", path("cal.toml")}),
              HasSubstr("a calibration is never overwritten"));
  const std::string chair = std::string(DTS_SOURCE_DIR) + "/config/rigs/chair-sim.toml";
  EXPECT_THAT(refusal_of({"cop", "two-feet", "--rig", chair, "--out", path("chair.toml")}), HasSubstr("needs 4"));
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
