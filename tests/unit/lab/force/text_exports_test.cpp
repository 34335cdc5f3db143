// SPDX-License-Identifier: Apache-2.0
// `dtslab force` with text exports: BioWare, Motive, tables with named columns, OpenSim.
#include "unit/lab/force/force_fixture.h"

namespace dts::lab::force {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using TextForce = ForceTest;

std::string bioware(const std::string& names, const std::string& units, const std::string& rows) {
  return "BioWare Version 5.2.1.3 Export\r\nDevice:\tKistler Grande2\r\nSamples (#):\t3\r\nRate "
         "(Hz):\t1000.000000\r\nDescription\tM\xFCller\r\n" +
         names + "\r\n" + units + "\r\n" + rows;
}

TEST_F(TextForce, BioWare_HasForcesAndNothingThatTheFileDoesNotHave) {
  const auto rows =
      force("b.txt", bioware("abs time (s)\tFx\tFy\tFz", "\tN\tN\tN", "0.000000\t1.5\t-0.25\t670.5\r\n0.001000\t1.9\t-0.17\t670.3\r\n"));
  ASSERT_EQ(rows.size(), 2U);
  expect_row(rows[1], {{"t_s", 0.001},
                       {"fx_n", 1.9},
                       {"fy_n", -0.17},
                       {"fz_n", 670.3},
                       {"mx_nm", kEmpty},
                       {"copx_mm", kEmpty},
                       {"copz_mm", kEmpty},
                       {"tz_nm", kEmpty}});
  EXPECT_EQ(json()["format"], "bioware");
  EXPECT_EQ(json()["rate_hz"], 1000.0);
  EXPECT_EQ(json()["point_rate_hz"], nullptr);
  EXPECT_EQ(json()["plates"][0]["type"], nullptr);
  EXPECT_EQ(json()["plates"][0]["mean"]["copx_mm"], nullptr);
}

TEST_F(TextForce, BioWareOfAnotherCountry_HasDecimalCommas) {
  const auto rows =
      force("b.txt", bioware("abs time\tFx\tFy\tFz\tAx\tAy\tTz'", "s\tN\tN\tN\tm\tm\tN.m",
                             "0,000\t1,5\t-0,25\t670,5\t0,0125\t-0,003\t1,25\r\n0,001\t1,5\t-0,25\t5,0\t0,0125\t-0,003\t1,25\r\n"));
  expect_row(rows[0], {{"fx_n", 1.5}, {"fz_n", 670.5}, {"copx_mm", 12.5}, {"copy_mm", -3.0}, {"copz_mm", 0.0}, {"tz_nm", 1.25}});
  expect_row(rows[1], {{"fz_n", 5.0}, {"copx_mm", kEmpty}, {"tz_nm", kEmpty}});
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("relative to their own mean")));
}

TEST_F(TextForce, BioWareOfTwoDevices_RepeatsTheNames) {
  const std::string text = bioware("abs time (s)\tFx\tFy\tFz\tFx\tFy\tFz\tAx\tAy", "\tN\tN\tN\tN\tN\tN\tm\tm",
                                   "0\t1\t2\t300\t4\t5\t600\t0.1\t0.2\r\n0.001\t1\t2\t300\t4\t5\t600\t0.1\t0.2\r\n");
  expect_row(force("b.txt", text)[0], {{"fz_n", 300.0}, {"copx_mm", kEmpty}});
  expect_row(force("b.txt", text, {"--plate", "2"})[0], {{"fz_n", 600.0}, {"copx_mm", 100.0}});
  EXPECT_EQ(run_with({"force", path("b.txt"), "--plate", "3"}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("has 2 plates"));
}

TEST_F(TextForce, BioWareWithMomentsAboutTheSurface_GivesTheirCentreOfPressure) {
  const std::string text = bioware("abs time (s)\tFx\tFy\tFz\tMx\tMy\tMx'\tMy'\tMz", "\tN\tN\tN\tN.m\tN.m\tN.m\tN.m\tN.m",
                                   "0\t12\t-10\t700\t9\t9\t12.48\t-4.224\t0.64\r\n0.001\t12\t-10\t700\t9\t9\t12.48\t-4.224\t0.64\r\n");
  expect_row(force("b.txt", text)[0],
             {{"mx_nm", 12.48}, {"my_nm", -4.224}, {"copx_mm", 6.0342857}, {"copy_mm", 17.8285714}, {"tz_nm", 0.9142857}});
}

TEST_F(TextForce, Motive_RepeatsTheTimeOfItsFrame_AndWritesZerosThatAreNoPosition) {
  const std::string text =
      "Name,trial 1\nDevice Name,AMTI 3265 3265\nSerial,3265\n\n\n"
      "MocapFrame, MocapTime, DeviceFrame, Fx, Fy, Fz, Mx, My, Mz, Cx, Cy, Cz\n"
      "0,0.000000,0,12,-10,700,12.48,-4.224,0.64,0.0060343,0.0178286,0\n"
      "0,0.000000,1,12,-10,700,12.48,-4.224,0.64,0.0060343,0.0178286,0\n"
      "1,0.010000,2,0,0,5,0.1,0.1,0,0,0,0\n"
      "1,0.010000,3,0,0,5,0.1,0.1,0,0,0,0\n"
      "2,0.020000,4,0,0,5,0.1,0.1,0,0,0,0\n";
  const auto rows = force("m.csv", text);
  ASSERT_EQ(rows.size(), 5U);
  expect_row(rows[1], {{"t_s", 0.005}, {"copx_mm", 6.0342857}, {"copy_mm", 17.8285714}, {"copz_mm", 0.0}, {"tz_nm", 0.9142857}});
  expect_row(rows[2], {{"fz_n", 5.0}, {"copx_mm", kEmpty}, {"tz_nm", kEmpty}});
  EXPECT_EQ(json()["format"], "motive");
  EXPECT_EQ(json()["rate_hz"], 200.0);
}

TEST_F(TextForce, Bertec_IsReadByTheNamesOfItsColumns) {
  const std::string text =
      "Bertec Acquire\nSubject,x\n\nSettings,1\nTime (s),CoPy (m),CoPx (m),Fz (N)\n0.00,-0.003,0.0125,650\n0.02,-0.003,0.0125,3\n";
  const auto rows = force("b.csv", text);
  expect_row(rows[0], {{"fx_n", kEmpty}, {"fz_n", 650.0}, {"mx_nm", kEmpty}, {"copx_mm", 12.5}, {"copy_mm", -3.0}});
  expect_row(rows[1], {{"fz_n", 3.0}, {"copx_mm", kEmpty}});
  EXPECT_EQ(json()["format"], "bertec");
  EXPECT_EQ(json()["rate_hz"], 50.0);
}

TEST_F(TextForce, CentreOfPressureOnly_IsGivenAsItIs) {
  const auto rows = force("cop.csv", "Time[s];COPx[cm];COPy[cm]\n0,00;1,25;-0,3\n0,01;;-0,3\n0,02;1,5;nan\n");
  expect_row(rows[0], {{"fz_n", kEmpty}, {"copx_mm", 12.5}, {"copy_mm", -3.0}, {"tz_nm", kEmpty}});
  expect_row(rows[1], {{"copx_mm", kEmpty}, {"copy_mm", -3.0}});
  expect_row(rows[2], {{"copx_mm", 15.0}, {"copy_mm", kEmpty}});
  EXPECT_NEAR(json()["plates"][0]["mean"]["copx_mm"].get<double>(), 13.75, 1e-9);
}

TEST_F(TextForce, SeveralPlatesOfATable_AreThoseWithNumbers) {
  const std::string text = "t_s,FP1_Fz,FP1_Mx,FP1_My,Fz2,Mx2,My2\n0,700,7,-14,100,1,1\n0.01,700,7,-14,100,1,1\n";
  expect_row(force("t.csv", text)[0], {{"copx_mm", 20.0}, {"copy_mm", 10.0}});
  expect_row(force("t.csv", text, {"--plate", "2"})[0], {{"copx_mm", -10.0}, {"copy_mm", 10.0}});
}

const std::string kMot =
    "walk.mot\nversion=1\nnRows=2\nnColumns=13\ninDegrees=yes\nendheader\n"
    "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_pz\t1_ground_force_vx\t"
    "1_ground_force_vy\t1_ground_force_vz\t1_ground_force_px\t1_ground_force_py\t1_ground_force_pz\tground_torque_x\tground_torque_y\t"
    "ground_torque_z\t1_ground_torque_x\t1_ground_torque_y\t1_ground_torque_z\n"
    "0.000\t10\t700\t-5\t0.1\t0.01\t-0.2\t1\t2\t3\t4\t5\t6\t0\t1.5\t0\t0\t2.5\t0\n"
    "0.002\t10\t700\t-5\t0.1\t0.01\t-0.2\t1\t200\t3\t4\t5\t6\t0\t1.5\t0\t0\t2.5\t0\n";

TEST_F(TextForce, OpenSim_IsInTheAxesOfTheLaboratory) {
  const auto first = force("w.mot", kMot);
  expect_row(first[0], {{"fx_n", 10.0},
                        {"fy_n", 700.0},
                        {"fz_n", -5.0},
                        {"mx_nm", kEmpty},
                        {"copx_mm", 100.0},
                        {"copy_mm", 10.0},
                        {"copz_mm", -200.0},
                        {"tz_nm", 1.5}});
  EXPECT_EQ(json()["rate_hz"], 500.0);
  EXPECT_EQ(json()["axes"], "lab");
  const auto second = force("w.mot", kMot, {"--plate", "2"});
  expect_row(second[0], {{"fy_n", 2.0}, {"copx_mm", kEmpty}, {"tz_nm", kEmpty}});
  expect_row(second[1], {{"fy_n", 200.0}, {"copx_mm", 4000.0}, {"tz_nm", 2.5}});
  ASSERT_EQ(run_with({"force", path("w.mot"), "--to", path("w.c3d")}), cli::kOk) << talk();
  ASSERT_EQ(run_with({"force", path("w.c3d"), "--axes", "plate", "--csv", path("again.csv")}), cli::kOk) << talk();
  expect_row(rows("again.csv")[0],
             {{"fx_n", 10.0}, {"fy_n", 5.0}, {"fz_n", 700.0}, {"copx_mm", 100.0}, {"copy_mm", 200.0}, {"tz_nm", 1.5}});
  ASSERT_EQ(run_with({"force", path("w.c3d"), "--axes", "lab", "--csv", path("lab.csv")}), cli::kOk) << talk();
  expect_row(rows("lab.csv")[0],
             {{"fx_n", 10.0}, {"fy_n", 700.0}, {"fz_n", -5.0}, {"copx_mm", 100.0}, {"copy_mm", 0.0}, {"copz_mm", -200.0}});
}

TEST_F(TextForce, OpenSimThatPointsDown_IsWarnedOf) {
  std::string turned = kMot;
  for (std::size_t at = turned.find("\t700\t"); at != std::string::npos; at = turned.find("\t700\t")) turned.replace(at, 5, "\t-700\t");
  force("w.mot", turned);
  EXPECT_THAT(json()["plates"][0]["warnings"], Contains(HasSubstr("vertical force points down")));
}

TEST_F(TextForce, OpenSimWithAnEmptyCell_KeepsTheColumnsBehindIt) {
  const std::string head = "walk.mot\nendheader\n";
  const std::string names =
      "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_pz\textra\n";
  const auto rows = force("gap.mot", head + names + "0\t1\t700\t2\t\t0.01\t0.2\t9\n0.01\t1\t700\t2\t0.1\t0.01\t0.2\t9\n");
  expect_row(rows[0], {{"fy_n", 700.0}, {"copx_mm", kEmpty}, {"copy_mm", 10.0}, {"copz_mm", 200.0}});
  expect_row(rows[1], {{"copx_mm", 100.0}, {"copy_mm", 10.0}, {"copz_mm", 200.0}});
  const auto spaces = force("s.mot", head + names + "0 1 700 2 0.1 0.01 0.2 9\n0.01 1 700 2 0.1 0.01 0.2 9\n");
  expect_row(spaces[1], {{"copx_mm", 100.0}, {"copz_mm", 200.0}});
  EXPECT_THAT(rejection("s.mot", head + names + "0 1 700 2 0.01 0.2 9\n0.01 1 700 2 0.1 0.01 0.2 9\n"),
              HasSubstr("line 4, column 1: 7 cells, but 8 names"));
}

TEST_F(TextForce, RateOfTheFile_IsThatOfAKeyAndAWarningNamesAContradiction) {
  const std::string rows = "Fz,Mx,My\n700,1,1\n700,1,1\n";
  EXPECT_THAT(rejection("r.csv", "Generated: 2014\nDescription,rate,5\n" + rows), HasSubstr("there is no rate"));
  for (const char* const key : {"Rate,250", "Sampling Rate (Hz):,250", "\"sample rate\",250"}) {
    force("r.csv", std::string(key) + "\n" + rows);
    EXPECT_EQ(json()["rate_hz"], 250.0) << key;
  }
  force("b.txt", bioware("abs time (s)\tFx\tFy\tFz", "\tN\tN\tN", "0\t1\t2\t700\r\n0.002\t1\t2\t700\r\n0.004\t1\t2\t700\r\n"));
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("states 1000 Hz, but its times have 500 Hz: 1000 Hz is used")));
}

TEST_F(TextForce, FirstRowOfUndefinedNumbers_IsNotTheRowOfUnits) {
  for (const char* const undefined : {",,", "nan,nan,nan", "NaN,,"}) {
    const auto rows = force("u.csv", std::string("Rate,100\nFz,Mx,My\n") + undefined + "\n700,1,1\n");
    ASSERT_EQ(rows.size(), 2U) << undefined;
    EXPECT_TRUE(std::isnan(rows[0].at("fz_n")));
  }
  EXPECT_EQ(force("u.csv", "Rate,100\nFz,Mx,My\nN,Nm,\n700,1,1\n").size(), 1U);
  EXPECT_EQ(force("u.csv", "Rate,100\nFz,Mx,My\n\n700,1,1\n").size(), 1U) << "an empty line";
}

TEST_F(TextForce, UnitsInNames_AreThoseThatAreConverted) {
  expect_row(force("u.csv", "t_ms,Fz_kN,Mx_Nmm,My_Ncm\n0,0.7,7000,-1400\n10,0.7,7000,-1400\n")[1],
             {{"t_s", 0.01}, {"fz_n", 700.0}, {"mx_nm", 7.0}, {"my_nm", -14.0}, {"copx_mm", 20.0}, {"copy_mm", 10.0}});
}

TEST_F(TextForce, EmptyRows_MayNotNeedMuchMoreMemoryThanTheFile) {
  std::string text = "Rate,100\nFx,Fy,Fz,Mx,My,Mz\n1,1,1,1,1,1\n";
  for (int row = 0; row < 2'000'000; ++row) text += ",,,,,\n";
  EXPECT_THAT(rejection("e.csv", text + "1,1,1,1,1,1\n"), HasSubstr("almost all cells of the 2000002 rows are empty"));
}

TEST_F(TextForce, LastRowThatIsCutOff_IsLeftOut) {
  EXPECT_EQ(force("t.csv", "time,Fz,Mx,My\n0,700,7,-14\n0.01,700,7,-14\n0.02,700,").size(), 2U);
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("line 4 is not complete")));
}

TEST_F(TextForce, WrongFile_SaysWhereInOneLine) {
  EXPECT_THAT(rejection("t.csv", "time,Fz,Mx,My\n0,700,7,-14\n0.01,seven,7,-14\n0.02,1,1,1\n"),
              HasSubstr("t.csv: line 3, column 6: 'seven' is not a number"));
  EXPECT_THAT(rejection("t.csv", "time,Fz,Mx,My\n0,700,7\n0.01,7,7,-14\n"), HasSubstr("line 2, column 1: 3 cells, the row needs 4"));
  EXPECT_THAT(rejection("t.csv", "Fx,Fy,Fz\n1,2,3\n1,2,3\n"), HasSubstr("there is no rate"));
  EXPECT_THAT(rejection("t.csv", "time,Fz,Mx,My\n"), HasSubstr("no row of numbers"));
  EXPECT_THAT(rejection("t.csv", "time,Fz,Mx,My\n0,1,1,1\n1,1,1,1\n0.5,1,1,1\n"), HasSubstr("row 3: the time is less"));
  EXPECT_THAT(rejection("t.csv", "1,2,3\n4,5,6\n"), HasSubstr("no line has the names"));
  EXPECT_THAT(rejection("t.csv", ""), HasSubstr("is empty"));
  EXPECT_THAT(rejection("t.csv", std::string(100000, 'x')), HasSubstr("longer than 64 KiB"));
  EXPECT_EQ(run_with({"force", directory_.string()}), cli::kFailed);
  EXPECT_EQ(run_with({"force", path("t.csv"), "--axes", "up"}), cli::kUsage);
  write("t.csv", "time,Fz,Mx,My\n0,700,7,-14\n0.01,700,7,-14\n");
  EXPECT_EQ(run_with({"force", path("t.csv"), "--axes", "lab"}), cli::kUsage) << "where the plate is, is not known";
}

/// 60 s at 50 Hz of a pendulum whose shear follows -p'' for positive signs: that on the plate.
std::string standing(double sign_x, double sign_y, bool is_exchanged) {
  std::ostringstream text;
  text << "time,Fx,Fy,Fz,Mx,My,Mz\n";
  for (int k = 0; k < 3000; ++k) {
    const double t = k / 50.0;
    const double x_m = 0.004 * std::sin(2 * M_PI * 0.5 * t) + 0.002 * std::sin(2 * M_PI * 0.31 * t + 1);
    const double y_m = 0.005 * std::sin(2 * M_PI * 0.4 * t) + 0.002 * std::sin(2 * M_PI * 0.63 * t + 2);
    double fx = sign_x * 200 * (0.004 * std::sin(2 * M_PI * 0.5 * t) + 0.001 * std::sin(2 * M_PI * 0.31 * t + 1));
    double fy = sign_y * 200 * (0.005 * std::sin(2 * M_PI * 0.4 * t) + 0.003 * std::sin(2 * M_PI * 0.63 * t + 2));
    if (is_exchanged) std::swap(fx, fy);
    text << t << ',' << fx << ',' << fy << ",700," << 700 * y_m << ',' << -700 * x_m << ",0\n";
  }
  return text.str();
}

TEST_F(TextForce, ShearAgainstTheCentreOfPressure_ContradictsIfAnAxisIsMirroredOrBothAreExchanged) {
  for (const double sign : {1.0, -1.0}) {
    force("s.csv", standing(sign, sign, false));
    EXPECT_TRUE(json()["warnings"].empty()) << json()["warnings"];
  }
  force("s.csv", standing(1, -1, false));
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("one horizontal axis is mirrored")));
  force("s.csv", standing(1, 1, true));
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("axes may be exchanged")));
}

TEST_F(TextForce, ShearOfAPendulum_ContradictsAVerticalForceOfTheOtherDirection) {
  for (const bool is_reaction : {true, false}) {
    std::ostringstream text;
    text << kMot.substr(0, kMot.find("time\t"))
         << "time\tground_force_vx\tground_force_vy\tground_force_vz\tground_force_px\tground_force_py\tground_force_pz\n";
    for (int k = 0; k < 3000; ++k) {  // m x'' = m g / l (x - p), as p = a sin wt gives it
      const double t = k / 50.0;
      const auto along = [t](double amplitude_m, double hz) { return amplitude_m * std::sin(2 * M_PI * hz * t); };
      const auto shear = [&](double amplitude_m, double hz) {
        const double w2 = 4 * M_PI * M_PI * hz * hz;
        return (is_reaction ? -1.0 : 1.0) * 70.0 * 9.81 * w2 / (9.81 + w2) * along(amplitude_m, hz);
      };
      text << t << '\t' << shear(0.004, 0.5) << "\t700\t" << shear(0.005, 0.4) << '\t' << along(0.004, 0.5) << "\t0\t" << along(0.005, 0.4)
           << '\n';
    }
    force("p.mot", text.str());
    const auto contradicts = Contains(HasSubstr("shear and vertical force contradict each other"));
    EXPECT_EQ(::testing::Value(json()["plates"][0]["warnings"], contradicts), !is_reaction) << json()["plates"][0]["warnings"];
  }
}

}  // namespace
}  // namespace dts::lab::force
