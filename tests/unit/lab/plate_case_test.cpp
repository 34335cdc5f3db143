// SPDX-License-Identifier: Apache-2.0
#include "lab/plate_case.h"

#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr auto kPlate = "[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = 4.0\ne_pa = 3.5e9\nnu = 0.31\n";
constexpr auto kSupport = "[support]\nkind = \"corner\"\n";
constexpr auto kLoad = "[[load]]\nx_mm = 215.0\ny_mm = 215.0\nforce_n = 9.80665\n";

/// 1 kgf on the acrylic plate of thesis 3.4, and the three sensing positions.
std::string acrylic_case(const std::string& more = "") {
  return std::string(kPlate) + kSupport + kLoad +
         "[[probe]]\nx_mm = 86\ny_mm = 86\n[[probe]]\nx_mm = 215\ny_mm = 86\n[[probe]]\nx_mm = 215\ny_mm = 215\n" + more;
}

class PlateCaseTest : public RunTest {
 protected:
  PlateCaseFile read(const std::string& text) {
    problems_.clear();
    return read_plate_case(write("case.toml", text), problems_);
  }

  files::Problems problems_;
};

TEST_F(PlateCaseTest, CompleteFile_IsReadWhole) {
  const PlateCaseFile file =
      read(std::string(kPlate) + "[support]\nkind = \"x-edges\"\n" +
           "[[load]]\nx0_mm = 10.0\nx1_mm = 30.0\ny0_mm = 100.0\ny1_mm = 150.0\nforce_n = 480\n" + "[[probe]]\nx_mm = 1.0\ny_mm = 2.0\n" +
           "[solver]\nnonlinear = true\ndivisions = 60\nmethod = \"fdm\"\nsimpson = true\n");

  ASSERT_TRUE(problems_.empty()) << problems_[0].text;
  EXPECT_EQ(file.plate_case.support.kind, physics::SupportKind::XEdges);
  ASSERT_EQ(file.plate_case.loads.size(), 1U);
  const physics::Patch& area = file.plate_case.loads[0].area;
  EXPECT_EQ(area.centre, (physics::Point{{20.0}, {125.0}}));
  EXPECT_EQ(area.width.value, 20.0);
  EXPECT_EQ(area.height.value, 50.0);
  EXPECT_TRUE(file.is_nonlinear);
  EXPECT_TRUE(file.spreads_point_loads);
  EXPECT_EQ(file.divisions, 60);
}

TEST_F(PlateCaseTest, RectanglesUpToTheEdges_StayOnThePlateWhateverTheRounding) {
  for (int k = 1; k < 200; ++k) {
    const std::string inner = std::to_string(0.1 * k + 0.037);
    for (const std::string& span : {"x0_mm = " + inner + "\nx1_mm = 430.0\n", "x0_mm = 0.0\nx1_mm = " + inner + "\n"}) {
      const PlateCaseFile file = read(std::string(kPlate) + kSupport + "[[load]]\n" + span + "y0_mm = 0\ny1_mm = 430\nforce_n = 1\n");
      ASSERT_TRUE(problems_.empty());
      EXPECT_TRUE(physics::check(file.plate_case, physics::PlateMethod::Fdm, {})) << span;
    }
  }
}

TEST_F(PlateCaseTest, WrongValues_AreAllReportedWithPlaceAndRange) {
  (void)read(
      "[plate]\na_mm = 430.0\nb_mm = nan\nh_mm = -3.0\ne_pa = inf\nnu = 0.5\n"
      "[support]\nkind = \"conrer\"\ninset_mm = 215.0\n"
      "[[load]]\nx_mm = 500.0\ny_mm = -1.0\nforce_n = 0.0\n"
      "[[probe]]\nx_mm = 430.1\ny_mm = \"a\"\nz_mm = 0\n"
      "[solver]\ndivisions = 5000\nnonlinaer = true\n");

  std::string all;
  for (const files::Problem& problem : problems_) all += std::to_string(problem.line) + ": " + problem.text + "\n";
  for (const char* expected :
       {"3: [plate] b_mm = nan is out of range; allowed: 10 .. 10000", "4: [plate] h_mm = -3 is out of range; allowed: 0.01 .. 86",
        "5: [plate] e_pa = inf is out of range", "6: nu = 0.5 is out of range; allowed: -1 .. 0.5 without 0.5",
        "8: [support] kind = \"conrer\" is not known; did you mean \"corner\"?", "9: inset_mm = 215 is out of range",
        "11: [[load]] x_mm = 500 is out of range; allowed: 0 .. 430", "12: [[load]] y_mm = -1 is out of range",
        "13: force_n of [[load]] is 0", "15: [[probe]] x_mm = 430.1 is out of range", "16: [[probe]] y_mm must be a number",
        "17: unknown key 'z_mm'", "19: [solver] divisions = 5000 is out of range; allowed: 4 .. 200", "20: unknown key 'nonlinaer'"}) {
    EXPECT_THAT(all, HasSubstr(expected));
  }
}

TEST_F(PlateCaseTest, MissingParts_AreNamed) {
  (void)read("");
  std::string all;
  for (const files::Problem& problem : problems_) all += problem.text + "\n";
  EXPECT_THAT(all, HasSubstr("[plate] is missing"));
  EXPECT_THAT(all, HasSubstr("[support] is missing"));
  EXPECT_THAT(all, HasSubstr("no [[load]]: name at least one"));

  (void)read(std::string(kPlate) + kSupport + "[[load]]\nx_mm = 1.0\nx0_mm = 0.0\n");
  all.clear();
  for (const files::Problem& problem : problems_) all += problem.text + "\n";
  EXPECT_THAT(all, HasSubstr("not both"));
  EXPECT_THAT(all, HasSubstr("x1_mm is missing"));
  EXPECT_THAT(all, HasSubstr("force_n is missing"));
}

TEST_F(PlateCaseTest, WrongKindsOfThings_AreReported) {
  for (const std::string& text : {std::string("[plate\n"), std::string(kPlate) + kSupport + "load = 3\n", std::string("plate = 3\n"),
                                  std::string(kPlate) + kSupport + kLoad + "[solver]\nnonlinear = 1\n",
                                  std::string(kPlate) + kSupport + kLoad + "[solver]\nmethod = \"fem\"\nsimpson = true\n",
                                  std::string(kPlate) + kSupport + kLoad + "[solver]\nnonlinear = true\ndivisions = 81\n",
                                  std::string(kPlate) + kSupport + "[[load]]\nx0_mm = 9\nx1_mm = 3\ny0_mm = 0\ny1_mm = 1\nforce_n = 1\n"}) {
    (void)read(text);
    EXPECT_FALSE(problems_.empty()) << text;
  }
}

// Thesis Table 3.2, FEM column at 1 kgf; tolerances of plate-model section 4 A.
TEST_F(PlateCaseTest, SolveJson_HasTheThesissDeflections) {
  const std::string file = write("case.toml", acrylic_case());
  for (const char* method : {"fdm", "fem"}) {
    EXPECT_EQ(run_with({"plate", "solve", file, "--method", method, "--divisions", "40", "--json"}), cli::kOk);

    const auto found = json();
    EXPECT_EQ(found.at("method"), method);
    EXPECT_EQ(found.at("divisions"), 40);
    EXPECT_NEAR(found.at("probes").at(0).at("deflection_mm").get<double>(), 2.030, 0.0203);
    EXPECT_NEAR(found.at("probes").at(1).at("deflection_mm").get<double>(), 2.709, 0.0135);
    EXPECT_NEAR(found.at("probes").at(2).at("deflection_mm").get<double>(), 3.430, 0.0103);
    EXPECT_EQ(found.at("probes").at(2).at("x_mm"), 215.0);
    ASSERT_EQ(found.at("reactions_n").size(), 4U);
    for (const auto& reaction : found.at("reactions_n")) EXPECT_NEAR(reaction.get<double>(), 9.80665 / 4.0, 1e-6);
    EXPECT_GT(found.at("solve_ms").get<double>(), 0.0);
  }
}

TEST_F(PlateCaseTest, CommandLine_WinsOverTheFile) {
  const std::string file = write("case.toml", acrylic_case("[solver]\nmethod = \"fem\"\ndivisions = 12\n"));

  EXPECT_EQ(run_with({"plate", "solve", file, "--json"}), cli::kOk);
  EXPECT_EQ(json().at("method"), "fem");
  EXPECT_EQ(json().at("divisions"), 12);

  EXPECT_EQ(run_with({"plate", "solve", file, "--method", "fdm", "--divisions", "10", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("method"), "fdm");
  EXPECT_EQ(json().at("divisions"), 10);
}

// The measured centre of thesis Table 3.2 is below the linear models' trend: stretching stiffens (research: -2.8 % at 1 kgf).
TEST_F(PlateCaseTest, Nonlinear_IsStiffer) {
  const std::string file = write("case.toml", acrylic_case());

  EXPECT_EQ(run_with({"plate", "solve", file, "--divisions", "20", "--json"}), cli::kOk);
  const double linear_mm = json().at("probes").at(2).at("deflection_mm");
  EXPECT_EQ(run_with({"plate", "solve", file, "--divisions", "20", "--nonlinear", "--json"}), cli::kOk);

  EXPECT_NEAR(json().at("probes").at(2).at("deflection_mm").get<double>() / linear_mm - 1.0, -0.028, 0.002);
  EXPECT_TRUE(json().at("nonlinear").get<bool>());
  EXPECT_GE(json().at("newton_iterations"), 1);
}

TEST_F(PlateCaseTest, BendingBeyondLinearTheory_IsWarnedOf) {
  const std::string file = write("case.toml", acrylic_case());

  EXPECT_EQ(run_with({"plate", "solve", file, "--divisions", "8", "--json"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("half its thickness (4.00 mm)")) << "3.4 mm of 4";
  EXPECT_THAT(talk(), HasSubstr("--nonlinear"));
  EXPECT_EQ(run_with({"plate", "solve", file, "--divisions", "8", "--nonlinear"}), cli::kOk);
  EXPECT_EQ(talk(), "");

  const std::string unprobed = write("unprobed.toml", std::string(kPlate) + kSupport + kLoad);
  EXPECT_EQ(run_with({"plate", "solve", unprobed, "--divisions", "8"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("--nonlinear")) << "wherever it bends, not only at probes";
}

// 430 mm / 10 is reached at some 12 times the load of 3.43 mm.
TEST_F(PlateCaseTest, DeflectionOfATenthOfTheSide_IsOutsideOfPlateTheory) {
  const std::string heavy = write("heavy.toml", std::string(kPlate) + kSupport + "[[load]]\nx_mm = 215.0\ny_mm = 215.0\nforce_n = 200\n");

  EXPECT_EQ(run_with({"plate", "solve", heavy, "--divisions", "8"}), cli::kOk);

  EXPECT_THAT(talk(), HasSubstr("outside of plate theory"));
  EXPECT_THAT(talk(), Not(HasSubstr("--nonlinear"))) << "would not help";
}

// Supports inset by 100 mm and a load on a free corner: the opposite support is pulled up.
TEST_F(PlateCaseTest, SupportThatWouldPull_IsWarnedOf) {
  const std::string file = write("tip.toml", std::string(kPlate) + "[support]\nkind = \"corner\"\ninset_mm = 100.0\n" +
                                                 "[[load]]\nx_mm = 5.0\ny_mm = 5.0\nforce_n = 1\n");

  EXPECT_EQ(run_with({"plate", "solve", file, "--divisions", "20"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("the plate lifts off this support"));

  const std::string middle = write("middle.toml", std::string(kPlate) + "[support]\nkind = \"corner\"\ninset_mm = 100.0\n" +
                                                      "[[load]]\nx_mm = 215.0\ny_mm = 215.0\nforce_n = 1\n");
  EXPECT_EQ(run_with({"plate", "solve", middle, "--divisions", "20"}), cli::kOk);
  EXPECT_EQ(talk(), "");
}

TEST_F(PlateCaseTest, CoarsestGrid_HasNoErrorEstimate) {
  const std::string file = write("case.toml", acrylic_case());

  EXPECT_EQ(run_with({"plate", "solve", file, "--divisions", "4", "--json"}), cli::kOk);

  EXPECT_FALSE(json().at("probes").at(0).contains("error_estimate_mm"));
}

TEST_F(PlateCaseTest, Table_ShowsProbesAndTheSumOfReactions) {
  EXPECT_EQ(run_with({"plate", "solve", write("case.toml", acrylic_case()), "--divisions", "40"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("    3  215.00  215.00"));
  EXPECT_THAT(out(), HasSubstr("sum                 9.807"));
}

TEST_F(PlateCaseTest, BadFile_ExitsWithTwoAndOneLinePerProblem) {
  const std::string file =
      write("case.toml", std::string("[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = -3.0\ne_pa = 2e11\nnu = 0.3\n") + kSupport);

  EXPECT_EQ(run_with({"plate", "solve", file, "--json"}), cli::kUsage);

  EXPECT_THAT(talk(), HasSubstr(file + ":4:8: [plate] h_mm = -3 is out of range; allowed: 0.01 .. 86\n"));
  EXPECT_THAT(talk(), HasSubstr("no [[load]]"));
  EXPECT_EQ(json().at("error").at("code"), "invalid_argument");
  EXPECT_THAT(json().at("error").at("message").get<std::string>(), HasSubstr("h_mm = -3"));

  EXPECT_EQ(run_with({"plate", "solve", path("none.toml")}), cli::kUsage);
  EXPECT_THAT(talk(), StartsWith(path("none.toml")));
}

}  // namespace
}  // namespace dts::lab
