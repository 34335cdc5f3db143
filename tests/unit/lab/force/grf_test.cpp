// SPDX-License-Identifier: Apache-2.0
// `dtslab grf`: what it writes, and what it rejects.
#include <cmath>
#include <sstream>

#include "unit/lab/run_fixture.h"

namespace dts::lab::force {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class GrfTest : public RunTest {
 protected:
  /// 40 s at 50 Hz: 4 mm at 0.5 Hz forward, 2 mm at 1 Hz to the side, 700 N.
  std::string standing(double load_amplitude_n = 0.0) {
    std::ostringstream text;
    text.precision(9);
    text << "t_s,x_mm,y_mm,load_n\n";
    for (int i = 0; i < 2000; ++i) {
      const double t = 5.0 + i / 50.0;
      text << t << ',' << 2.0 * std::sin(2.0 * M_PI * t) << ',' << 4.0 * std::sin(M_PI * t) << ',' << 700.0 + load_amplitude_n * std::sin(t)
           << '\n';
    }
    return write("standing.csv", text.str());
  }
};

TEST_F(GrfTest, Standing_GivesForcesAgainstTheDisplacementAndEmptyCellsAtTheEnds) {
  ASSERT_EQ(run_with({"grf", standing(), "--height", "1.8", "--csv", path("force.csv"), "--json"}), cli::kOk) << talk();
  const auto document = json();
  EXPECT_EQ(document["band_hz"], nlohmann::json({0.1, 2.0}));
  EXPECT_NEAR(document["effective_length_m"].get<double>(), 1.25 * 0.55 * 1.8, 1e-9);
  EXPECT_NEAR(document["mass_kg"].get<double>(), 700.0 / 9.81, 1e-6);
  EXPECT_EQ(document["supported_samples"], 2000 - 2 * 150);
  EXPECT_TRUE(document["warnings"].empty());
  std::istringstream lines(content("force.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "t_s,fx_n,fy_n,fz_n");
  std::getline(lines, line);
  EXPECT_EQ(line, "5,,,700");
  for (int i = 1; i <= 975; ++i) std::getline(lines, line);  // t = 24.5 s: sin(pi t) = 1, sin(2 pi t) = 0
  EXPECT_THAT(line, StartsWith("24.5,"));
  const double ap_n = std::stod(line.substr(line.find(',', 5) + 1));
  const double w2 = M_PI * M_PI;
  const double w02 = 9.81 / (1.25 * 0.55 * 1.8);
  EXPECT_NEAR(ap_n, -700.0 / 9.81 * w02 * w2 / (w02 + w2) * 0.004, 0.02);
}

TEST_F(GrfTest, LoadThatVaries_IsWarnedOf) {
  ASSERT_EQ(run_with({"grf", standing(100.0), "--height", "1.8", "--csv", path("force.csv")}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("the load varies"));
  EXPECT_THAT(out(), HasSubstr("EXPECTED ERROR"));
}

TEST_F(GrfTest, WrongHeightShortRecordingOrMissingColumn_IsRejected) {
  const std::string file = standing();
  EXPECT_EQ(run_with({"grf", file, "--height", "180", "--csv", path("force.csv")}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("between 0.5 and 2.5 m"));
  EXPECT_EQ(run_with({"grf", file, "--height", "1.8", "--csv", file}), cli::kUsage) << "would overwrite its input";
  EXPECT_EQ(run_with({"grf", write("short.csv", "t_s,x_mm,y_mm,load_n\n0,1,1,700\n0.1,1,2,700\n0.2,1,1,700\n"), "--height", "1.8", "--csv",
                      path("force.csv")}),
            cli::kFailed);
  EXPECT_THAT(talk(), HasSubstr("26 s"));
  EXPECT_EQ(run_with({"grf", write("no_load.csv", "t_s,x_mm,y_mm\n0,1,1\n"), "--height", "1.8", "--csv", path("force.csv")}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("load_n"));
}

}  // namespace
}  // namespace dts::lab::force
