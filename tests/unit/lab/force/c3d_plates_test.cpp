// SPDX-License-Identifier: Apache-2.0
// `dtslab force` with C3D files: the four types, where the origin is, what is wrong with a plate.
#include "unit/lab/force/force_fixture.h"

namespace dts::lab::force {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using C3dForce = ForceTest;

const ForceTest::Row kKistler{{"fx_n", 12.0},   {"fy_n", -10.0},        {"fz_n", 700.0},         {"mx_nm", 12.480}, {"my_nm", -4.224},
                              {"mz_nm", 0.640}, {"copx_mm", 6.0342857}, {"copy_mm", 17.8285714}, {"copz_mm", 0.0},  {"tz_nm", 0.9142857}};
const std::vector<double> kKistlerChannels{5, 7, -4, -6, 200, 180, 150, 170};

/// A file of one plate, with the same sample in each frame.
MadeC3d one_plate(const MadeC3d::Plate& plate, const std::vector<double>& sample, int frames = 2, const std::vector<int>& zero = {1, 0}) {
  MadeC3d made;
  made.channels = static_cast<int>(sample.size());
  made.plates({plate}, zero);
  for (int frame = 0; frame < frames; ++frame) made.frame(sample);
  return made;
}

std::vector<int> first_channels(int count) {
  std::vector<int> channels;
  for (int k = 1; k <= count; ++k) channels.push_back(k);
  return channels;
}

/// The numbers of Kistler's sheet, for both signs of az0.
TEST_F(C3dForce, Type3_IsKistlersSumsAndOnlyZOfItsOriginTurns) {
  for (const double z : {-48.0, 48.0}) {
    const auto rows =
        force("k.c3d", one_plate({.type = 3, .origin = {120, 200, z}, .channels = first_channels(8)}, kKistlerChannels).bytes());
    ASSERT_EQ(rows.size(), 2U);
    expect_row(rows[1], kKistler);
    EXPECT_EQ(rows[1].at("t_s"), 0.01);
    const auto plate = json()["plates"][0];
    EXPECT_EQ(plate["type"], 3);
    EXPECT_EQ(plate["origin_mm"], nlohmann::json({120.0, 200.0, z}));
    EXPECT_EQ(plate["size_mm"], nlohmann::json({400.0, 400.0}));
    EXPECT_EQ(plate["zero_frames"], nlohmann::json({1, 0}));
    EXPECT_EQ(plate["zero_applied"], false);
    EXPECT_NEAR(plate["mean"]["fz_n"].get<double>(), 700.0, 1e-9);
  }
}

/// The same load, seen from a transducer at (-1, -2, 40) of the surface's centre.
TEST_F(C3dForce, Type2_MovesTheMomentToTheSurface_AndAPositiveZTurnsTheWholeVector) {
  // M = M' - F x o with o = (1, 2, -40): F x o = (-10*-40 - 700*2, 700*1 - 12*-40, 12*2 - -10*1) = (-1000, 1180, 34) N mm
  const std::vector<double> channels{12, -10, 700, 12480 + 1000, -4224 - 1180, 640 - 34};
  for (const double sign : {1.0, -1.0}) {
    const auto rows =
        force("a.c3d", one_plate({.type = 2, .origin = {sign, 2 * sign, -40 * sign}, .channels = first_channels(6)}, channels).bytes());
    expect_row(rows[0], kKistler);
  }
}

TEST_F(C3dForce, Type4_MultipliesByTheMatrixColumnByColumn) {
  std::vector<double> matrix(36, 0.0);
  for (int k = 0; k < 6; ++k) matrix[static_cast<std::size_t>(k * 6 + k)] = 2.0;
  matrix[5 * 6 + 0] = 0.5;  // column 6, row 1: Fx gets half of the sixth channel
  const std::vector<double> channels{(12 - 0.5 * 320) / 2.0, -5, 350, 6240, -2112, 320};
  const auto rows = force("m.c3d", one_plate({.type = 4, .channels = first_channels(6), .matrix = matrix}, channels).bytes());
  expect_row(rows[0], kKistler);
  const auto without = force("n.c3d", one_plate({.type = 4, .channels = first_channels(6)}, {12, -10, 700, 12480, -4224, 640}).bytes());
  expect_row(without[0], kKistler);
  EXPECT_THAT(talk(), HasSubstr("CAL_MATRIX is missing"));
}

TEST_F(C3dForce, Type1_HasAPointAndAFreeMoment_WithoutOriginAndZero) {
  MadeC3d made = one_plate({.type = 1, .origin = {7, 8, 9}, .channels = first_channels(6)}, {12, -10, 700, 6.0342857, 17.8285714, 914.2857},
                           2, {1, 2});
  const auto rows = force("p.c3d", made.bytes(), {"--zero", "file"});
  expect_row(rows[0], kKistler);
  EXPECT_EQ(json()["plates"][0]["zero_applied"], false);
}

TEST_F(C3dForce, LaboratoryAxes_AreThoseOfTheCorners) {
  const auto rows =
      force("k.c3d", one_plate({.type = 3, .origin = {120, 200, -48}, .channels = first_channels(8)}, kKistlerChannels).bytes(),
            {"--axes", "lab"});
  expect_row(rows[0], {{"fx_n", 12.0},
                       {"fy_n", 10.0},
                       {"fz_n", -700.0},
                       {"mx_nm", 12.480},
                       {"my_nm", 4.224},
                       {"mz_nm", -0.640},
                       {"copx_mm", 206.0342857},
                       {"copy_mm", 182.1714286},
                       {"copz_mm", 0.0}});
  EXPECT_THAT(talk(), HasSubstr("vertical force points down"));
}

TEST_F(C3dForce, Metres_AreReadAsPointUnitsSayAndNotAsAnalogUnits) {
  MadeC3d made;
  made.channels = 6;
  made.group("POINT");
  made.text("UNITS", "m");
  made.group("ANALOG");
  made.texts("UNITS", 3, {"N", "N", "N", "Nmm", "Nmm", "Nmm"});
  made.plates({{.type = 2, .origin = {0, 0, 0}, .channels = first_channels(6)}});
  made.frame({12, -10, 700, 12.480, -4.224, 0.640});
  expect_row(force("metres.c3d", made.bytes())[0], kKistler);
}

TEST_F(C3dForce, ZeroOfTheFile_IsSubtractedOnlyIfItIsAskedFor) {
  MadeC3d made;
  made.channels = 6;
  made.plates({{.type = 2, .channels = first_channels(6)}}, {1, 2});
  made.frame({1, 0, 10, 0, 0, 0});
  made.frame({3, 0, 20, 0, 0, 0});
  made.frame({12, 0, 700, 0, 0, 0});
  expect_row(force("z.c3d", made.bytes())[2], {{"fx_n", 12.0}, {"fz_n", 700.0}});
  expect_row(force("z.c3d", made.bytes(), {"--zero", "file"})[2], {{"fx_n", 10.0}, {"fz_n", 685.0}});
  EXPECT_EQ(json()["plates"][0]["zero_applied"], true);
}

TEST_F(C3dForce, Polynomial_IsNamedAndAppliedOnlyIfItIsAskedFor) {
  MadeC3d made = one_plate({.type = 3, .origin = {120, 200, -48}, .channels = first_channels(8)}, kKistlerChannels);
  made.reals("FPCOPPOLY", {12, 1}, {0, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0, 0});
  expect_row(force("k.c3d", made.bytes())[0], kKistler);
  EXPECT_EQ(json()["plates"][0]["cop_poly"]["x"], nlohmann::json({0.0, 0.0, 0.0, 0.0, 0.0, 0.5}));
  expect_row(force("k.c3d", made.bytes(), {"--cop-poly", "file"})[0], {{"copx_mm", 0.5 * 6.0342857}, {"copy_mm", 17.8285714}});
  EXPECT_EQ(json()["plates"][0]["cop_poly_applied"], true);
}

TEST_F(C3dForce, SmallForceOrNaN_LeavesCellsEmpty) {
  MadeC3d made;
  made.channels = 6;
  made.plates({{.type = 2, .channels = first_channels(6)}});
  made.frame({1, 2, 19.9, 100, 100, 5});
  made.frame({kEmpty, 2, 100, 100, 100, 5});
  made.frame({1, 2, std::numeric_limits<double>::infinity(), 100, 100, 5});
  const auto rows = force("s.c3d", made.bytes());
  expect_row(rows[0], {{"fz_n", 19.9}, {"mx_nm", 0.1}, {"copx_mm", kEmpty}, {"copy_mm", kEmpty}, {"copz_mm", kEmpty}, {"tz_nm", kEmpty}});
  expect_row(rows[1], {{"fx_n", kEmpty}, {"fy_n", 2.0}, {"fz_n", 100.0}, {"copx_mm", -1.0}, {"copy_mm", 1.0}, {"tz_nm", kEmpty}});
  expect_row(rows[2], {{"fz_n", kEmpty}, {"fx_n", 1.0}, {"copx_mm", kEmpty}});
  expect_row(force("s.c3d", made.bytes(), {"--min-force", "10"})[0], {{"copx_mm", -100.0 / 19.9}});
  EXPECT_THAT(content("out.csv"), ::testing::Not(HasSubstr("nan")));
  EXPECT_THAT(content("out.csv"), ::testing::Not(HasSubstr("inf")));
}

TEST_F(C3dForce, PlateThatCannotBeRead_IsEmptyAndTheOthersAreRead) {
  struct Case {
    MadeC3d::Plate plate;
    std::string says;
  };
  const std::vector<int> some{1, 2, 3, 4, 5, 6, 1, 2};
  for (const Case& bad :
       {Case{{.type = 21, .channels = some}, "type 21 is not read"}, Case{{.type = 3, .origin = {0, 200, -48}, .channels = some}, "a_mm"},
        Case{{.type = 3, .origin = {120, 0, -48}, .channels = some}, "b_mm"},
        Case{{.type = 2, .channels = {1, 2, 3, 4, 5, 7, 1, 1}}, "channel 7, the file has channels 1 to 6"},
        Case{{.type = 2, .channels = {1, 2, 0, 4, 5, 6, 1, 1}}, "channel 0"}}) {
    MadeC3d made;
    made.channels = 6;
    made.plates({{.type = 2, .channels = some}, bad.plate});
    made.frame({12, -10, 700, 12480, -4224, 640});
    expect_row(force("two.c3d", made.bytes())[0], kKistler);
    EXPECT_THAT(json()["plates"][1]["warnings"], Contains(HasSubstr(bad.says)));
    EXPECT_EQ(json()["plates"][1]["mean"]["fx_n"], nullptr);
    EXPECT_EQ(json()["plates"][1]["loaded_samples"], 0);
    expect_row(force("two.c3d", made.bytes(), {"--plate", "2"})[0], {{"fx_n", kEmpty}, {"copx_mm", kEmpty}});
  }
  MadeC3d rows_missing;
  rows_missing.channels = 8;
  rows_missing.plates({{.type = 3, .origin = {120, 200, -48}, .channels = first_channels(6)}});
  rows_missing.frame(kKistlerChannels);
  EXPECT_THAT(rejection("short.c3d", rows_missing.bytes()), HasSubstr("CHANNEL has 6 rows, type 3 needs 8"));
}

/// A small file could otherwise need minutes.
TEST_F(C3dForce, ManyPlatesThatShareTheirChannels_AreNotAllRead) {
  MadeC3d made(MadeEncoding::Intel, false);
  made.channels = 1;
  made.samples_per_frame = 10;
  made.plates(std::vector<MadeC3d::Plate>(64, {.type = 2, .channels = std::vector<int>(6, 1)}));
  for (int frame = 0; frame < 10000; ++frame) made.frame(std::vector<double>(10, 300.0));
  ASSERT_EQ(run_with({"force", write("many.c3d", made.bytes()), "--json"}), cli::kOk) << talk();
  ASSERT_EQ(json()["plates"].size(), 64U);
  EXPECT_EQ(json()["plates"][19]["usable"], true);
  EXPECT_EQ(json()["plates"][20]["usable"], false);
  EXPECT_THAT(json()["plates"][20]["warnings"], Contains(HasSubstr("share 1 channels")));
}

TEST_F(C3dForce, ZeroThatCannotBeSubtracted_IsWarnedOf) {
  const MadeC3d::Plate plate{.type = 2, .channels = first_channels(6)};
  const std::vector<double> sample{12, -10, 700, 12480, -4224, 640};
  force("z.c3d", one_plate(plate, sample, 2, {3, 5}).bytes(), {"--zero", "file"});
  EXPECT_THAT(json()["plates"][0]["warnings"], Contains(HasSubstr("ZERO has frames 3 to 5")));
  force("z.c3d", one_plate(plate, sample, 2, {1, 2}).bytes(), {"--zero", "file"});
  EXPECT_THAT(talk(), ::testing::Not(HasSubstr("no effect")));
  force("z.csv", "time,Fz,Mx,My\n0,700,7,-14\n0.01,700,7,-14\n", {"--zero", "file"});
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("only C3D has ZERO")));
}

TEST_F(C3dForce, MatrixWithNaN_IsSaid) {
  std::vector<double> matrix(36, 1.0);
  matrix[7] = kEmpty;
  force("n.c3d", one_plate({.type = 4, .channels = first_channels(6), .matrix = matrix}, {12, -10, 700, 12480, -4224, 640}).bytes());
  EXPECT_THAT(talk(), HasSubstr("has a number that is not finite"));
}

TEST_F(C3dForce, FileThatIsCutOff_HasTheFramesBefore) {
  std::string bytes = one_plate({.type = 2, .channels = first_channels(6)}, {12, -10, 700, 12480, -4224, 640}, 5).bytes();
  bytes.resize(bytes.size() - 3);
  EXPECT_EQ(force("cut.c3d", bytes).size(), 4U);
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("ends after frame 4 of 5")));
}

TEST_F(C3dForce, NoPlates_IsNotReadable) {
  MadeC3d made;
  made.channels = 1;
  made.frame({1});
  EXPECT_THAT(rejection("none.c3d", made.bytes()), HasSubstr("FORCE_PLATFORM has no plate"));
  EXPECT_THAT(rejection("bad.c3d", std::string("\2\x50garbage", 9)), HasSubstr("within its header"));
  EXPECT_EQ(run_with({"force", path("absent.c3d")}), cli::kFailed);
  EXPECT_EQ(run_with({"force", path("none.c3d"), "--plate", "0"}), cli::kUsage);
}

TEST_F(C3dForce, EightBytesOfEveryFile_MayBeAnything) {
  RecordProperty("requirement", "SEC-9");
  const std::string bytes = one_plate({.type = 3, .origin = {120, 200, -48}, .channels = first_channels(8)}, kKistlerChannels).bytes();
  for (std::size_t at = 0; at < bytes.size(); at += 13) {
    std::string changed = bytes;
    for (std::size_t k = at; k < std::min(at + 8, bytes.size()); ++k) changed[k] = '\xFF';
    const int status = run_with({"force", write("x.c3d", changed), "--csv", path("x.csv"), "--json"});
    EXPECT_TRUE(status == cli::kOk || status == cli::kFailed) << at << ": " << talk();
  }
}

/// What is written reads back as the same float32, with undefined values undefined.
TEST_F(C3dForce, WrittenAsC3d_ReadsBackAsTheSameFloats) {
  MadeC3d made;
  made.channels = 6;
  made.group("EVENT");
  made.words("USED", {}, {1});
  made.texts("LABELS", 8, {"Foot off"});
  made.texts("CONTEXTS", 5, {"Right"});
  made.reals("TIMES", {2, 1}, {0, 0.02});
  made.plates({{.type = 2, .origin = {1, 2, -40}, .channels = first_channels(6)}, {.type = 9, .channels = first_channels(6)}});
  for (int k = 0; k < 60; ++k) made.frame({12.1 + k, -10.3, -700.7 + 17 * k, 1248.123, -422.456 + k, 64.789});
  const auto before = force("in.c3d", made.bytes(), {"--to", path("out.c3d")});
  EXPECT_THAT(json()["warnings"], Contains(HasSubstr("cannot have their moments"))) << "some samples are below 20 N";
  ASSERT_EQ(run_with({"force", path("out.c3d"), "--csv", path("again.csv"), "--json"}), cli::kOk);
  EXPECT_EQ(json()["events"], 1);
  EXPECT_EQ(json()["plates"][0]["type"], 1);
  const auto after = rows("again.csv");
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t k = 0; k < after.size(); ++k) {
    for (const char* name : {"fx_n", "fy_n", "fz_n", "copx_mm", "copy_mm"}) {
      if (std::isnan(before[k].at(name))) {
        EXPECT_TRUE(std::isnan(after[k].at(name)));
      } else {
        EXPECT_EQ(static_cast<float>(before[k].at(name)), static_cast<float>(after[k].at(name))) << name;
      }
    }
  }
  EXPECT_EQ(run_with({"force", path("out.c3d"), "--to", path("out.c3d")}), cli::kUsage) << "would overwrite its input";
  EXPECT_EQ(run_with({"force", path("in.c3d"), "--csv", path("both"), "--to", path("./both")}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("--csv and --to both name the file"));
  EXPECT_FALSE(std::filesystem::exists(path("both")));
}

}  // namespace
}  // namespace dts::lab::force
