// SPDX-License-Identifier: Apache-2.0
// Real recordings of other laboratories, beside values that another program computed. They are not part of the project: the test is
// skipped if they are not there.
#include "unit/lab/force/force_fixture.h"

namespace dts::lab::force {
namespace {

using Reference = ForceTest;

std::filesystem::path data_folder() {
  const char* const named = std::getenv("DTS_SHARED_DATA");
  return std::filesystem::path(named != nullptr ? named : DTS_SOURCE_DIR "/../shared/data") / "plates";
}

TEST_F(Reference, EveryPlate_HasTheValuesOfTheReference) {
  RecordProperty("requirement", "LAB-5");
  std::ifstream file(data_folder() / "reference.csv");
  if (!file) GTEST_SKIP() << data_folder() << " is not there";
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = cells(line);
  std::size_t count = 0;
  for (; std::getline(file, line); ++count) {
    const std::vector<std::string> values = cells(line);
    for (const char* axes : {"plate", "lab"}) {
      ASSERT_EQ(run_with({"force", (data_folder() / values[0]).string(), "--plate", values[1], "--axes", axes, "--min-force", "0", "--csv",
                          path("out.csv")}),
                cli::kOk)
          << talk();
      const Row row = rows("out.csv").at(std::stoul(values[3]));
      const std::string prefix = axes == std::string("lab") ? "lab_" : "";
      for (const char* name : {"fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm", "copx_mm", "copy_mm", "copz_mm", "tz_nm"}) {
        const auto at = std::ranges::find(names, prefix + name);
        if (at == names.end()) continue;
        const double expected = std::stod(values[static_cast<std::size_t>(at - names.begin())]);
        const double digits = 5e-6;  // the reference has six digits
        if (std::isnan(expected)) {
          EXPECT_TRUE(std::isnan(row.at(name))) << line << ": " << name;
        } else {
          EXPECT_NEAR(row.at(name), expected, digits * std::abs(expected) + 1e-6) << line << ": " << axes << " " << name;
        }
      }
    }
  }
  EXPECT_GT(count, 30U);
}

TEST_F(Reference, OneRecordingInThreeEncodings_IsTheSame) {
  if (!std::filesystem::exists(data_folder())) GTEST_SKIP() << data_folder() << " is not there";
  std::string first;
  for (const char* name : {"d1_type2_pc_int.c3d", "d2_type2_dec_real.c3d", "d3_type2_sgi_int.c3d"}) {
    ASSERT_EQ(run_with({"force", (data_folder() / name).string(), "--plate", "2", "--csv", path("out.csv")}), cli::kOk) << talk();
    if (first.empty()) first = content("out.csv");
    const auto found = rows("out.csv");
    std::ofstream(directory_ / "first.csv") << first;
    const auto expected = rows("first.csv");
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); k += 7) expect_row(found[k], expected[k], 2e-6);
  }
}

/// The recordings' own centre of pressure, from their forces and moments.
TEST_F(Reference, QuietStandingAsText_HasItsOwnCentreOfPressureAndNoContradiction) {
  if (!std::filesystem::exists(data_folder())) GTEST_SKIP() << data_folder() << " is not there";
  for (const char* name : {"bds_firm_open_164p0cm.txt", "bds_firm_closed_181p5cm.txt"}) {
    ASSERT_EQ(run_with({"force", (data_folder() / name).string(), "--csv", path("out.csv"), "--json"}), cli::kOk) << talk();
    EXPECT_EQ(json()["rate_hz"], 100.0);
    EXPECT_TRUE(json()["warnings"].empty()) << json()["warnings"];
    std::ifstream file(data_folder() / name);
    std::string line;
    std::getline(file, line);
    const auto found = rows("out.csv");
    for (std::size_t k = 0; k < found.size(); ++k) {
      std::getline(file, line);
      std::istringstream words(line);
      std::vector<double> values;
      for (double value = 0.0; words >> value;) values.push_back(value);
      ASSERT_EQ(values.size(), 9U);
      EXPECT_NEAR(found[k].at("copx_mm"), 10.0 * values[7], 1e-3);
      EXPECT_NEAR(found[k].at("copy_mm"), 10.0 * values[8], 1e-3);
    }
  }
}

}  // namespace
}  // namespace dts::lab::force
