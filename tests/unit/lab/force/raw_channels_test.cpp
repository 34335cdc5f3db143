// SPDX-License-Identifier: Apache-2.0
// `dtslab force --plate-file`: volts of a DAQ and the plate to which they belong.
#include "unit/lab/force/force_fixture.h"

namespace dts::lab::force {
namespace {

using ::testing::HasSubstr;

class RawForce : public ForceTest {
 protected:
  std::vector<Row> raw(const std::string& plate, const std::string& channels) {
    const std::string file = write("plate.toml", plate);
    return force("raw.csv", channels, {"--plate-file", file, "--axes", "plate"});
  }
  std::string plate_rejection(const std::string& plate) {
    const std::string file = write("plate.toml", plate);
    return rejection("raw.csv", "t_s,c1\n0,1\n1,1\n", {"--plate-file", file});
  }
};

const std::string kKistler =
    "[force_plate]\nkind = \"kistler8\"\nscale_mv_per_n = [2, 2, 2, 2, 4, 4, 4, 4]\na_mm = 120\nb_mm = 200\naz0_mm = -48\n";
const std::string kVolts =
    "t_s,c1,c2,c3,c4,c5,c6,c7,c8\n0,0.010,0.014,-0.008,-0.012,0.8,0.72,0.6,0.68\n0.5,0.010,0.014,-0.008,-0.012,0.8,0.72,0.6,0.68\n";

TEST_F(RawForce, Kistler8_IsTheExampleOfItsSheet) {
  const auto rows = raw(kKistler, kVolts);
  expect_row(rows[1], {{"t_s", 0.5},
                       {"fx_n", 12.0},
                       {"fy_n", -10.0},
                       {"fz_n", 700.0},
                       {"mx_nm", 12.480},
                       {"my_nm", -4.224},
                       {"mz_nm", 0.640},
                       {"copx_mm", 6.0342857},
                       {"copy_mm", 17.8285714},
                       {"tz_nm", 0.9142857}});
  EXPECT_EQ(json()["format"], "raw");
  const std::string ranges =
      "[force_plate]\nkind = \"kistler8\"\nsensitivity_pc_per_n = [8, 8, 8, 8, 4, 4, 4, 4]\nrange_pc = [40000, 40000, 40000, 40000, 10000, "
      "10000, 10000, 10000]\n"
      "full_scale_v = 10\na_mm = 120\nb_mm = 200\naz0_mm = -48\n";  // 500 N/V and 250 N/V
  expect_row(raw(ranges, kVolts)[0], {{"fx_n", 12.0}, {"fz_n", 700.0}, {"copx_mm", 6.0342857}});
}

TEST_F(RawForce, TareAndPolynomial_AreApplied) {
  const std::string plate =
      kKistler +
      "cop_poly_x = [0, 0, 0, 0, 0, 0.5]\ncop_poly_y = [0, 0, 0, 0, 0, 0]\n[force_plate.tare]\nvolts = [0, 0, 0, 0, 0.1, 0.1, 0.1, 0.1]\n";
  expect_row(raw(plate, kVolts)[0], {{"fz_n", 600.0}, {"copx_mm", 0.5 * 4.224 / 0.6}});
}

TEST_F(RawForce, SixComponents_ByMatrixOrBySensitivity) {
  const std::string volts = "t_s,c1,c2,c3,c4,c5,c6\n0,0.1,0.2,1,0.1,0.2,0.05\n1,0.1,0.2,1,0.1,0.2,0.05\n";
  const std::string matrix =
      "[[10, 0, 0, 0, 0, 0], [0, 20, 0, 0, 0, 0], [1, 0, 500, 0, 0, 0], [0, 0, 0, 50, 0, 0], [0, 0, 0, 0, 60, 0], [0, 0, 0, 0, 0, 70]]";
  expect_row(raw("[force_plate]\nkind = \"six_component\"\nmatrix = " + matrix + "\nmatrix_unit = \"n_per_v\"\nsurface_mm = [0, 0, -40]\n",
                 volts)[0],
             {{"fx_n", 1.0}, {"fy_n", 4.0}, {"fz_n", 500.1}, {"mx_nm", 5.0 + 4.0 * -0.04}, {"my_nm", 12.0 + 0.04}, {"mz_nm", 3.5}});
  // 2 uV/(V N) at 10 V and a gain of 1000: 20 mV/N; 1 V is 50 N.
  const std::string diagonal =
      "[[2, 0, 0, 0, 0, 0], [0, 2, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0], [0, 0, 0, 2, 0, 0], [0, 0, 0, 0, 2, 0], [0, 0, 0, 0, 0, 2]]";
  const std::string amplifier =
      "excitation_v = [10, 10, 10, 10, 10, 10]\ngain = [1000, 1000, 1000, 1000, 1000, 1000]\nsurface_mm = [0, 0, 0]\n";
  expect_row(raw("[force_plate]\nkind = \"six_component\"\nsensitivity = " + diagonal + "\n" + amplifier, volts)[0],
             {{"fx_n", 5.0}, {"fz_n", 50.0}, {"my_nm", 10.0}});
  expect_row(
      raw("[force_plate]\nkind = \"six_component\"\nmatrix = " + diagonal + "\nmatrix_unit = \"n_per_uv_per_v\"\n" + amplifier, volts)[0],
      {{"fx_n", 20.0}, {"fz_n", 200.0}});
}

TEST_F(RawForce, LoadCells_HaveNoShearAndNoFreeMoment) {
  const std::string plate =
      "[force_plate]\nkind = \"load_cells\"\nposition_mm = [[200, 100], [-200, 100], [-200, -100], [200, -100]]\nscale_n_per_v = [100, "
      "100, 100, 200]\n";
  const auto rows = raw(plate, "t_s,c1,c2,c3,c4\n0,1,2,3,2\n1,0,0,0,0\n");
  expect_row(rows[0], {{"fx_n", kEmpty},
                       {"fy_n", kEmpty},
                       {"fz_n", 1000.0},
                       {"mx_nm", 10.0 + 20.0 - 30.0 - 40.0},
                       {"my_nm", 0.0},
                       {"mz_nm", kEmpty},
                       {"copx_mm", 0.0},
                       {"copy_mm", -40.0},
                       {"tz_nm", kEmpty}});
  expect_row(rows[1], {{"fz_n", 0.0}, {"copx_mm", kEmpty}});
  expect_row(raw("[force_plate]\nkind = \"load_cells\"\nposition_mm = [[0, 100], [-100, -100], [100, -100]]\nscale_n_per_v = 100\n",
                 "t_s,c1,c2,c3\n0,1,1,1\n1,1,1,1\n")[0],
             {{"fz_n", 300.0}, {"copy_mm", -100.0 / 3.0}});
}

TEST_F(RawForce, AxesOfThePlate_AreThoseOfTheWarningsAndOfTheC3dFile) {
  const std::string cells =
      "[force_plate]\nkind = \"load_cells\"\nposition_mm = [[0, 100], [-100, -100], [100, -100]]\nscale_n_per_v = 100\naxes = ";
  for (const bool is_down : {true, false}) {
    raw(cells + (is_down ? "\"z_down\"\n" : "\"z_up\"\n"), "t_s,c1,c2,c3\n0,2,2,2\n0.1,2,2,2\n");
    EXPECT_EQ(talk().find("vertical force points down") != std::string::npos, is_down) << talk();
    ASSERT_EQ(run_with({"force", path("raw.csv"), "--plate-file", path("plate.toml"), "--to", path("raw.c3d")}), cli::kOk) << talk();
    ASSERT_EQ(run_with({"force", path("raw.c3d"), "--axes", "lab", "--json"}), cli::kOk) << talk();
    EXPECT_NEAR(json()["plates"][0]["mean"]["fz_n"].get<double>(), is_down ? -600.0 : 600.0, 1e-3);
    EXPECT_EQ(talk().find("vertical force points down") != std::string::npos, is_down) << talk();
  }
}

TEST_F(RawForce, WrongPlateFile_SaysWhereAndWhatWasMeant) {
  EXPECT_THAT(plate_rejection(kKistler + "cop_poly_z = [0]\n"),
              HasSubstr("plate.toml:7:1: unknown key 'cop_poly_z' in [force_plate]; did you mean 'cop_poly_"));
  EXPECT_THAT(plate_rejection("[force_plate]\nkind = \"kistler\"\n"), HasSubstr("did you mean \"kistler8\"?"));
  EXPECT_THAT(plate_rejection("[force_plat]\nkind = \"kistler8\"\n"), HasSubstr("did you mean 'force_plate'?"));
  EXPECT_THAT(plate_rejection("[force_plate]\nkind = \"kistler8\"\nscale_mv_per_n = [2, 2]\na_mm = 1\nb_mm = 1\naz0_mm = -1\n"),
              HasSubstr("plate.toml:3:18: scale_mv_per_n must be a list of 8 numbers"));
  EXPECT_THAT(plate_rejection(
                  "[force_plate]\nkind = \"kistler8\"\nscale_mv_per_n = [2, 2, 2, 2, 4, 4, 4, 4]\na_m = 120\nb_mm = 200\naz0_mm = -48\n"),
              HasSubstr("unknown key 'a_m' in [force_plate]; did you mean 'a_mm'?"));
  std::string up = kKistler;
  up.replace(up.find("-48"), 3, "48");
  EXPECT_THAT(plate_rejection(up), HasSubstr("az0_mm = 48 is out of range"));
  EXPECT_THAT(plate_rejection("[force_plate]\nkind = \"load_cells\"\nposition_mm = [[0, 0], [1, 1], [2, 2]]\nscale_n_per_v = 1\n"),
              HasSubstr("in a line"));
  EXPECT_THAT(plate_rejection("[force_plate]\nkind = \"six_component\"\nmatrix_unit = \"n_per_v\"\nsurface_mm = [0, 0, 0]\nmatrix = "
                              "[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,1,0]]\n"),
              HasSubstr("matrix is singular"));
  EXPECT_THAT(plate_rejection("not toml"), HasSubstr("plate.toml:1:"));
}

TEST_F(RawForce, WrongChannels_SayWhere) {
  const std::string file = write("plate.toml", kKistler);
  EXPECT_THAT(rejection("raw.csv", "t_s,c1,c2\n0,1,2\n1,1,2\n", {"--plate-file", file}), HasSubstr("line 1: column 'c3' is missing"));
  EXPECT_THAT(rejection("raw.csv", "t_s,c1,c2,c3,c4,c5,c6,c7,c8\n0,1,1,1,1,1,1,1,1\n0,1,1,1,1,1,1,1,1\n", {"--plate-file", file}),
              HasSubstr("line 3: t_s does not increase"));
}

}  // namespace
}  // namespace dts::lab::force
