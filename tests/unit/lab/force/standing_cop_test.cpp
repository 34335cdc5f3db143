// SPDX-License-Identifier: Apache-2.0
// `sway`, `compare` and `steadiness classify` with files of force plates.
#include "unit/lab/force/force_fixture.h"

namespace dts::lab::force {
namespace {

using ::testing::HasSubstr;

class StandingCop : public ForceTest {
 protected:
  /// Two plates of 400 mm beside each other, 30 s at 50 Hz; the load moves from one to the other, 700 N together.
  [[nodiscard]] std::string two_plates() const {
    MadeC3d made;
    made.channels = 12;
    made.rate_hz = 50;
    made.group("FORCE_PLATFORM");
    made.words("USED", {}, {2});
    made.words("TYPE", {2}, {2, 2});
    made.words("ZERO", {2}, {1, 0});
    made.reals("CORNERS", {3, 4, 2}, {400, 0, 0, 0, 0, 0, 0, 400, 0, 400, 400, 0, 800, 0, 0, 400, 0, 0, 400, 400, 0, 800, 400, 0});
    made.reals("ORIGIN", {3, 2}, {0, 0, 0, 0, 0, 0});
    made.words("CHANNEL", {6, 2}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    for (int k = 0; k < 1500; ++k) {
      const double part = 0.5 + 0.01 * std::sin(2 * M_PI * 0.4 * k / 50.0);
      const double y_mm = 5 * std::cos(2 * M_PI * 0.3 * k / 50.0);
      const double first = -700 * (1 - part);
      const double second = -700 * part;
      made.frame({0, 0, first, first * y_mm, 0, 0, 0, 0, second, second * y_mm, 0, 0});
    }
    return made.bytes();
  }
  /// The same movement as a CSV file in the subject's axes.
  [[nodiscard]] static std::string as_csv() {
    std::ostringstream text;
    text.precision(12);
    text << "t_s,x_mm,y_mm,load_n\n";
    for (int k = 0; k < 1500; ++k) {
      text << k / 50.0 << ',' << 400 + 400 * 0.01 * std::sin(2 * M_PI * 0.4 * k / 50.0) << ','
           << 200 - 5 * std::cos(2 * M_PI * 0.3 * k / 50.0) << ",700\n";
    }
    return text.str();
  }
};

TEST_F(StandingCop, NetOfTwoPlates_HasTheMeasuresOfTheWholeBody) {
  const std::string file = write("two.c3d", two_plates());
  ASSERT_EQ(run_with({"sway", file, "--plate", "net", "--ml", "+x", "--ap", "+y", "--json"}), cli::kOk) << talk();
  const auto net = json()["measures"];
  ASSERT_EQ(run_with({"sway", write("same.csv", as_csv()), "--json"}), cli::kOk);
  const auto same = json()["measures"];
  for (const char* measure : {"MVELO", "RDIST", "RANGE"})
    EXPECT_NEAR(net[measure]["value"].get<double>(), same[measure]["value"].get<double>(), 1e-4) << measure;
  ASSERT_EQ(run_with({"sway", file, "--plate", "2", "--ml", "-x", "--ap", "-y", "--json"}), cli::kOk) << talk();
  EXPECT_LT(json()["measures"]["MVELO"]["value"].get<double>(), net["MVELO"]["value"].get<double>())
      << "alone, its centre moves along one axis";
  ASSERT_EQ(run_with({"compare", file, path("same.csv"), "--plate", "net", "--ml", "+x", "--ap", "+y", "--json"}), cli::kOk) << talk();
  EXPECT_LT(json()["rmse_total_mm"].get<double>(), 0.01);
}

TEST_F(StandingCop, PlateWithASmallForceAndNoPoint_LeavesTheNet) {
  MadeC3d made;
  made.channels = 12;
  made.rate_hz = 50;
  made.plates({{.type = 1, .channels = {1, 2, 3, 4, 5, 6}}, {.type = 1, .channels = {7, 8, 9, 10, 11, 12}}});
  for (int k = 0; k < 1500; ++k) {
    const double x_mm = 4 * std::sin(2 * M_PI * 0.4 * k / 50.0);
    made.frame({0, 0, -700, x_mm, 3 * std::cos(0.05 * k), 0, 0, 0, -5, kEmpty, kEmpty, kEmpty});
  }
  const std::string file = write("two.c3d", made.bytes());
  ASSERT_EQ(run_with({"sway", file, "--plate", "net", "--ml", "+x", "--ap", "+y", "--json"}), cli::kOk) << talk();
  const auto net = json()["measures"]["MVELO"]["value"].get<double>();
  ASSERT_EQ(run_with({"sway", file, "--plate", "1", "--ml", "+x", "--ap", "-y", "--json"}), cli::kOk) << talk();
  EXPECT_NEAR(net, json()["measures"]["MVELO"]["value"].get<double>(), 1e-6);
}

TEST_F(StandingCop, NetOfTheOnlyPlateOfATextFile_IsThatPlate) {
  std::ostringstream text;
  text << "time,Fz,Mx,My\n";
  for (int k = 0; k < 1500; ++k) text << k / 50.0 << ",700," << std::sin(0.05 * k) << ',' << std::cos(0.07 * k) << '\n';
  const std::string file = write("one.csv", text.str());
  ASSERT_EQ(run_with({"sway", file, "--plate", "net", "--ml", "+x", "--ap", "-y", "--json"}), cli::kOk) << talk();
  const auto net = json()["measures"];
  ASSERT_EQ(run_with({"sway", file, "--plate", "1", "--ml", "+x", "--ap", "-y", "--json"}), cli::kOk) << talk();
  EXPECT_EQ(net, json()["measures"]);
  const std::string two = write("two.csv", "time,Fz1,Mx1,My1,Fz2,Mx2,My2\n0,700,1,1,700,1,1\n0.02,700,1,1,700,1,1\n");
  EXPECT_THAT(refusal_of({"sway", two, "--plate", "net", "--ml", "+x", "--ap", "-y"}), HasSubstr("does not say where the plates are"));
}

/// A table with positions is not a file of force plates because it has other columns, too.
TEST_F(StandingCop, TableOfPositions_IsReadAsOne_WithColumnsOfForcesToo) {
  for (const char* const names : {"t_s,x_mm,y_mm,fz,ax,ay", "t_s,ml_mm,ap_mm,fx,fz,my"}) {
    std::ostringstream text;
    text << names << '\n';
    for (int k = 0; k < 1500; ++k) text << k / 50.0 << ',' << std::sin(0.05 * k) << ',' << std::cos(0.07 * k) << ",700,1,2\n";
    const std::string file = write("positions.csv", text.str());
    EXPECT_EQ(run_with({"sway", file}), cli::kOk) << talk();
    EXPECT_EQ(run_with({"compare", file, file}), cli::kOk) << talk();
  }
}

TEST_F(StandingCop, AxesThatAreNotGiven_AreAskedForWithTheReason) {
  const std::string file = write("two.c3d", two_plates());
  EXPECT_THAT(refusal_of({"sway", file}), HasSubstr("does not say how the subject stands on the plate"));
  EXPECT_THAT(talk(), HasSubstr("--ml +x --ap -y"));
  EXPECT_THAT(refusal_of({"sway", file, "--ml", "+x", "--ap", "-x"}), HasSubstr("same axis"));
  EXPECT_THAT(refusal_of({"sway", file, "--ml", "+x", "--ap", "-z"}), HasSubstr("z is the vertical axis"));
  EXPECT_THAT(refusal_of({"sway", file, "--plate", "3", "--ml", "+x", "--ap", "-y"}), HasSubstr("has 2 plates"));
  EXPECT_THAT(refusal_of({"sway", file, "--plate", "all", "--ml", "+x", "--ap", "-y"}), HasSubstr("--plate"));
  EXPECT_THAT(refusal_of({"compare", file, file}), HasSubstr("does not say how the subject stands"));
  EXPECT_THAT(refusal_of({"compare", file, file, "--ml", "+x", "--ap", "-y"}), HasSubstr("--plate counts for both"));
  EXPECT_THAT(talk(), HasSubstr("--plate 2 --csv plate2.csv"));
  EXPECT_THAT(refusal_of({"steadiness", "train", file, "--label", "eyes", "--out", path("m.json")}),
              HasSubstr("is one trial on force plates"));
}

}  // namespace
}  // namespace dts::lab::force
