// SPDX-License-Identifier: Apache-2.0
// sim:floor as a calibration bench: weights of a list, spacers before the sensors.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "unit/device/sim_rig.h"

namespace dts::device {
namespace {

using test::Bench;
using test::Recorded;

constexpr std::size_t kBenchMl = 4;
constexpr std::size_t kBenchAp = 5;
constexpr std::size_t kBenchLoad = 6;

/// A list of weights that lives as long as the test.
class WeightFile {
 public:
  explicit WeightFile(const std::string& rows) : path_(test::temporary_path("weights.csv")) {
    std::ofstream(path_) << "x_mm,y_mm,load_n\n" << rows;
  }
  ~WeightFile() { std::filesystem::remove(path_); }
  WeightFile(const WeightFile&) = delete;
  WeightFile& operator=(const WeightFile&) = delete;
  [[nodiscard]] std::string uri(const std::string& options) const { return "sim:floor?contact=weights&weights=" + path_ + options; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string bench_refusal(const std::string& uri) {
  core::VirtualClock clock;
  const physics::RigModel rig = test::floor_rig();
  const auto device = create_device(uri, {clock, rig});
  return device ? "" : core::to_string(device.error());
}

Recorded record(const std::string& uri, double duration_s) {
  Bench bench(uri);
  bench.start(100);
  return bench.read_scans(static_cast<std::size_t>(100 * duration_s));
}

TEST(SimWeights, EachRow_AppearsInTheTruthForItsTime) {
  const WeightFile file("-129,0,240\n64.5,-64.5,700\n");

  const Recorded recorded = record(file.uri("&step_on_s=1&ramp_s=0.2&hold_s=1&pause_s=0.6"), 6);

  const auto truth = [&](std::size_t channel, double time_s) { return recorded.channels[channel][static_cast<std::size_t>(100 * time_s)]; };
  EXPECT_EQ(truth(kBenchLoad, 0.9), 0.0);
  EXPECT_TRUE(std::isnan(truth(kBenchMl, 0.9)));
  EXPECT_NEAR(truth(kBenchLoad, 1.1), 120.0, 1e-9);  // half way up the ramp
  EXPECT_EQ(truth(kBenchLoad, 1.7), 240.0);
  EXPECT_EQ(truth(kBenchMl, 1.7), -129.0);
  EXPECT_EQ(truth(kBenchAp, 1.7), 0.0);
  EXPECT_EQ(truth(kBenchLoad, 2.7), 0.0);
  EXPECT_TRUE(std::isnan(truth(kBenchAp, 2.7)));
  EXPECT_EQ(truth(kBenchLoad, 3.7), 700.0);
  EXPECT_EQ(truth(kBenchMl, 3.7), 64.5);
  EXPECT_EQ(truth(kBenchAp, 3.7), -64.5);
  EXPECT_EQ(truth(kBenchLoad, 5.9), 0.0);
}

TEST(SimWeights, Resting_BendsAsTheSamePointContact) {
  const WeightFile file("-43,64.5,490\n");

  const Recorded list = record(file.uri("&step_on_s=0&noise_mv=0"), 3);
  const Recorded point = record("sim:floor?contact=point&load_n=490&x_mm=-43&y_mm=64.5&step_on_s=0&noise_mv=0", 3);

  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(list.channels[i][200], point.channels[i][200]) << i;
}

TEST(SimWeights, BadRow_RefusedWithFileAndLine) {
  for (const auto& [rows, answer] : {std::pair{"0,0,100\n216,0,100\n", ":3: not on the plate"},
                                     {"0,0,100\n0,-215.001,100\n", ":3: not on the plate"},
                                     {"215,-215,1\n-215,215,2000\n", ""},
                                     {"0,0,2000.1\n", ":2: load_n is out of range; allowed: 1 .. 2000"},
                                     {"0,0,0.999\n", ":2: load_n is out of range; allowed: 1 .. 2000"},
                                     {"0,0\n", ":2: \"0,0\" is not 3 numbers"},
                                     {"", "too few rows, at least 1 needed"}}) {
    const std::string refusal = bench_refusal(WeightFile(rows).uri(""));
    EXPECT_NE(refusal.find(answer), std::string::npos) << refusal;
    EXPECT_EQ(refusal.empty(), *answer == '\0') << rows << refusal;
  }
}

TEST(SimGaps, EverySensor_SeesExactlyTheGapsInTurn) {
  const Recorded recorded =
      record("sim:floor?contact=gaps&gaps_mm=12,9,7.5&step_on_s=1&ramp_s=0.1&hold_s=1&pause_s=0.8&noise_mv=0&bits=16", 7);

  const physics::SensorCurve curve = physics::SensorCurve::hoa1405_assumed();
  const double half_code_v = 10.0 / 65536 / 2.0;
  const auto expect_gap = [&](double time_s, double gap_mm) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double volts = recorded.channels[i][static_cast<std::size_t>(100 * time_s)];
      EXPECT_NEAR(volts, curve.volts(core::Millimetres{gap_mm}).value, half_code_v * 1.001) << time_s << " s, sensor " << i;
    }
  };
  const double far_mm = curve.maximum_gap().value;
  expect_gap(0.5, far_mm);
  expect_gap(1.6, 12.0);
  expect_gap(2.6, far_mm);
  expect_gap(3.6, 9.0);
  expect_gap(5.6, 7.5);
  expect_gap(6.9, far_mm);
  EXPECT_EQ(recorded.channels[kBenchLoad][160], 0.0);
  EXPECT_TRUE(std::isnan(recorded.channels[kBenchMl][160]));
}

}  // namespace
}  // namespace dts::device
