// SPDX-License-Identifier: Apache-2.0
#include "accuracy/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "accuracy/low_pass.h"
#include "accuracy/recording_file.h"

namespace dts::accuracy {
namespace {

std::string recording(const std::string& name) {
  return std::filesystem::path(DTS_SOURCE_DIR).parent_path() / "shared" / "data" / "cop" / (name + ".csv");
}

TEST(SwayMeasures, Square_HasItsLengthAndClosedFormEllipse) {
  const Locus square{{1, -1, -1, 1}, {1, 1, -1, -1}};

  const SwayMeasures measures = sway_measures(square);

  EXPECT_DOUBLE_EQ(measures.path_length_mm, 6.0);
  // S = 4/3 on the diagonal; factor (16 - 1)/4 * (0.05^-1 - 1)
  EXPECT_NEAR(measures.ellipse_mm2, M_PI * 4.0 / 3.0 * 3.75 * 19.0, 1e-9);
}

TEST(SwayMeasures, StandingStill_IsZero) {
  const SwayMeasures measures = sway_measures({std::vector<double>(100, 3.0), std::vector<double>(100, -2.0)});

  EXPECT_EQ(measures.path_length_mm, 0.0);
  EXPECT_EQ(measures.ellipse_mm2, 0.0);
}

/// Check values of the posturography sheet, section 10.
struct CheckValue {
  const char* name;
  double path_mm;
  double ellipse_mm2;
};

TEST(SwayMeasures, RecordingAsItIs_GivesThePublishedValues) {
  const auto file = read_recording(recording("d01_bds00073_young_eo_firm"));
  if (!file) GTEST_SKIP() << recording("d01_bds00073_young_eo_firm") << " is not here";

  const SwayMeasures measures = sway_measures(file->locus);

  EXPECT_NEAR(measures.path_length_mm, 491.2699105, 1e-7);
  EXPECT_NEAR(measures.ellipse_mm2, 304.5967518695401, 1e-9);  // by the authors of the data set
}

TEST(SwayMeasures, RecordingsAfterLp10_GiveTheSheetsCheckValues) {
  for (const auto& [name, path_mm, ellipse_mm2] :
       {CheckValue{"d01_bds00073_young_eo_firm", 484.1745146, 304.5930332},
        CheckValue{"d02_bds00079_young_ec_firm", 559.946233, 254.5757577}, CheckValue{"d03_acuna_eo2_1000hz", 257.3061208, 115.8295333}}) {
    const auto file = read_recording(recording(name));
    if (!file) GTEST_SKIP() << recording(name) << " is not here";
    const double rate_hz = std::round(file->rate_hz);

    const SwayMeasures full_rate = sway_measures({lp10(file->locus.ml_mm, rate_hz), lp10(file->locus.ap_mm, rate_hz)});
    const SwayMeasures at_hundred = sway_measures_lp10(file->locus, rate_hz);

    EXPECT_NEAR(full_rate.path_length_mm, path_mm, 1e-8 * path_mm) << name;
    EXPECT_NEAR(full_rate.ellipse_mm2, ellipse_mm2, 1e-8 * ellipse_mm2) << name;
    // Section 2: 8.04 mm/s at 1000 Hz and at 100 Hz. The ellipse factor knows the number of samples.
    EXPECT_NEAR(at_hundred.path_length_mm, path_mm, 1e-3 * path_mm) << name;
    EXPECT_NEAR(at_hundred.ellipse_mm2, ellipse_mm2, 2e-3 * ellipse_mm2) << name;
  }
}

TEST(Compare, GainOffsetAndNothingElse_AreFound) {
  const std::vector<double> truth = {-2, -1, 0, 1, 2};
  std::vector<double> published;
  for (const double value : truth) published.push_back(0.9 * value + 3.0);

  const Agreement agreement = compare(published, truth);

  EXPECT_NEAR(agreement.offset_mm, 3.0, 1e-12);
  EXPECT_NEAR(agreement.gain, 0.9, 1e-12);
  EXPECT_NEAR(agreement.centred_rmse_mm, 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(agreement.rmse_mm, std::hypot(3.0, agreement.centred_rmse_mm), 1e-12);
  EXPECT_NEAR(agreement.residual_mm, 0.0, 1e-7);
}

TEST(Compare, TruthThatStandsStill_HasNoGainAndTheScatterRemains) {
  const Agreement agreement = compare(std::vector<double>{1, 3, 1, 3}, std::vector<double>{5, 5, 5, 5});

  EXPECT_TRUE(std::isnan(agreement.gain));
  EXPECT_DOUBLE_EQ(agreement.offset_mm, -3.0);
  EXPECT_DOUBLE_EQ(agreement.centred_rmse_mm, 1.0);
  EXPECT_DOUBLE_EQ(agreement.residual_mm, 1.0);
}

TEST(ReadRecording, WrongOrAbsentFile_IsNothing) {
  EXPECT_FALSE(read_recording("/nonexistent.csv"));
  EXPECT_FALSE(read_recording(std::string(DTS_SOURCE_DIR) + "/CMakeLists.txt"));
}

TEST(ReadRecording, EvenRows_GiveRateAndCentredLocus) {
  const auto path = std::filesystem::path(testing::TempDir()) / "accuracy_rows.csv";
  std::ofstream(path) << "t_s,x_mm,y_mm\n0.5,1,10\n0.52,2,20\n0.54,3,30\n";

  const auto file = read_recording(path);

  ASSERT_TRUE(file);
  EXPECT_NEAR(file->rate_hz, 50.0, 1e-9);
  EXPECT_NEAR(file->duration_s(), 0.04, 1e-12);
  EXPECT_EQ(file->locus.ml_mm, (std::vector<double>{-1, 0, 1}));
  EXPECT_NEAR(file->ap_mm_at(0.01), -5.0, 1e-9);
  EXPECT_NEAR(file->ap_mm_at(9.0), 10.0, 1e-9);
}

}  // namespace
}  // namespace dts::accuracy
