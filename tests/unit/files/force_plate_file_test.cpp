// SPDX-License-Identifier: Apache-2.0
#include "files/force_plate_file.h"

#include <gmock/gmock.h>

#include <array>

#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ForcePlateFileTest : public FilesTest {
 protected:
  std::optional<ForcePlateFile> read(const std::string& text) {
    problems_.clear();
    return read_force_plate(write("plate.toml", text), problems_);
  }
  /// Texts of the problems.
  std::vector<std::string> problems_of(const std::string& text) {
    EXPECT_FALSE(read(text).has_value());
    std::vector<std::string> texts;
    for (const Problem& problem : problems_) texts.push_back(problem.text);
    return texts;
  }

  Problems problems_;
};

TEST_F(ForcePlateFileTest, LoadCells_WithTareAndAxes) {
  const auto file = read(
      "[force_plate]\nkind = \"load_cells\"\naxes = \"z_up\"\nposition_mm = [[200, 100], [-200, 100], [0, -100]]\nscale_n_per_v = [100, "
      "100, 200]\n[force_plate.tare]\nvolts = [0.1, 0.2, 0.3]\n");
  ASSERT_TRUE(file.has_value()) << to_string(problems_.front());
  EXPECT_EQ(file->kind, "load_cells");
  EXPECT_FALSE(file->is_z_down);
  EXPECT_FALSE(file->polynomial.has_value());
  EXPECT_THAT(file->tare_volts, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_DOUBLE_EQ(file->plate.wrench(std::array{1.0, 1.0, 1.0}).force_n[2], 400.0);
}

TEST_F(ForcePlateFileTest, EveryProblemOfATable_HasItsPlace) {
  EXPECT_THAT(problems_of("[force_plate]\nkind = \"load_cells\"\n"),
              ElementsAre("[force_plate] position_mm is missing", "[force_plate] scale_n_per_v is missing"));
  EXPECT_THAT(problems_of("[force_plate]\nkind = \"load_cells\"\nposition_mm = [[1, 2], [3, 4]]\nscale_n_per_v = 1\n"),
              ElementsAre("position_mm must be a list of 3 or 4 pairs of numbers"));
  EXPECT_THAT(problems_of("[force_plate]\nkind = \"kistler8\"\nscale_mv_per_n = [2, 2, 2, 0, 4, 4, 4, 4]\na_mm = 120\nb_mm = 200\naz0_mm = "
                          "0\n"),
              ElementsAre("scale_mv_per_n has a 0", HasSubstr("az0_mm = 0 is out of range")));
  EXPECT_THAT(problems_of("[force_plate]\nkind = \"kistler8\"\nscale_mv_per_n = [2, 2]\na_mm = 120\nb_mm = 200\naz0_mm = -48\n"),
              ElementsAre("scale_mv_per_n must be a list of 8 numbers"));
  EXPECT_THAT(problems_of("[force_plate]\nkind = \"six_component\"\nmatrix = [[1, 2]]\nmatrix_unit = \"n_per_uv_per_v\"\ngain = [1]\n"),
              ElementsAre("matrix must be a list of 6 rows of 6 numbers", "[force_plate] excitation_v is missing",
                          "gain must be a list of 6 numbers", "[force_plate] surface_mm is missing"));
  EXPECT_THAT(problems_of("[force_plate]\nkind = \"six_component\"\nmatrix = [[1, 2]]\nmatrix_unit = \"n_per_v\"\nsurface_mm = [0, 0]\n"),
              ElementsAre("matrix must be a list of 6 rows of 6 numbers", "surface_mm must be a list of 3 numbers"));
  EXPECT_THAT(problems_of("kind = 1\n"), ElementsAre("force_plate is missing", HasSubstr("unknown key 'kind'")));
}

TEST_F(ForcePlateFileTest, KeysThatDoNotGoTogether_AreNotCalledUnknown) {
  const std::string eight = " = [2, 2, 2, 2, 4, 4, 4, 4]\n";
  const std::string kistler = "[force_plate]\nkind = \"kistler8\"\na_mm = 120\nb_mm = 200\naz0_mm = -48\nscale_mv_per_n" + eight;
  EXPECT_THAT(problems_of(kistler + "sensitivity_pc_per_n" + eight),
              ElementsAre("scale_mv_per_n and sensitivity_pc_per_n exclude each other: give one of the two"));
  EXPECT_THAT(problems_of(kistler + "range_pc" + eight + "full_scale_v = 10\n"),
              ElementsAre("range_pc is used only with sensitivity_pc_per_n: remove it",
                          "full_scale_v is used only with sensitivity_pc_per_n: remove it"));
  const std::string ones = " = [[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]\n";
  const std::string six = "[force_plate]\nkind = \"six_component\"\nsurface_mm = [0, 0, 0]\n";
  const std::string volts = "matrix_unit = \"n_per_v\"\n";
  const std::string amplifier = "excitation_v = [1, 1, 1, 1, 1, 1]\ngain = [1, 1, 1, 1, 1, 1]\n";
  EXPECT_THAT(problems_of(six + volts + "matrix" + ones + "gain = [1, 1, 1, 1, 1, 1]\n"),
              ElementsAre("gain is used only with matrix_unit = \"n_per_uv_per_v\" or sensitivity: remove it"));
  EXPECT_THAT(problems_of(six + volts + "matrix" + ones + "sensitivity" + ones),
              ElementsAre("matrix and sensitivity exclude each other: give one of the two"));
  EXPECT_THAT(problems_of(six + volts + amplifier + "sensitivity" + ones), ElementsAre("matrix_unit is used only with matrix: remove it"));
}

}  // namespace
}  // namespace dts::files
