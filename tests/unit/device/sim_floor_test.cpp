// SPDX-License-Identifier: Apache-2.0
// What sim:floor measures: physics, converter, truth and recordings. Time and faults are in sim_device_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "physics/plate/influence_table.h"
#include "physics/plate/stiffening_plate.h"
#include "unit/device/sim_rig.h"

namespace dts::device {
namespace {

using test::Bench;
using test::Recorded;

constexpr std::size_t kTrueMl = 4;
constexpr std::size_t kTrueAp = 5;
constexpr std::size_t kTrueLoad = 6;

Recorded record(const std::string& uri, double rate_hz, double duration_s, std::size_t block_scans = 64) {
  Bench bench(uri);
  bench.start(rate_hz);
  return bench.read_scans(static_cast<std::size_t>(rate_hz * duration_s), block_scans);
}

/// NaN equals NaN: nobody on the plate both times.
bool same(const std::vector<double>& a, const std::vector<double>& b, std::size_t count) {
  return std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(count), b.begin(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

constexpr const char* kExactPoint = "sim:floor?contact=point&load_n=490&x_mm=-43&y_mm=64.5&noise_mv=0&bits=16&gap_spread_mm=0";

std::vector<physics::Point> probes_of(const physics::RigModel& rig) {
  std::vector<physics::Point> probes;
  for (const physics::SensorModel& sensor : rig.sensors) probes.push_back(sensor.position);
  return probes;
}

/// Deflections of the sensors after five seconds, out of the converter's volts.
std::array<double, 4> measured_mm(const std::string& uri) {
  const physics::RigModel rig = test::floor_rig();
  const Recorded recorded = record(uri, 100, 5);
  std::array<double, 4> deflection_mm{};
  for (std::size_t i = 0; i < deflection_mm.size(); ++i) {
    const core::Volts measured{recorded.channels[i].back()};
    deflection_mm[i] = rig.sensors[i].unloaded_gap.value - rig.sensors[i].curve.gap(measured).value;
  }
  return deflection_mm;
}

constexpr double kCodeMm = (10.0 / 65536) / 0.35;  // one code where the curve is flattest, 0.35 V/mm

TEST(SimFloor, PointLoad_DeflectionsAreThePlatesAndTruthIsTheOptions) {
  const physics::RigModel rig = test::floor_rig();
  const auto table = physics::InfluenceTable::create(rig.plate, rig.support, probes_of(rig));
  const auto plate = physics::StiffeningPlate::create(rig.plate, rig.support, probes_of(rig));
  ASSERT_TRUE(table.has_value() && plate.has_value());
  const physics::Point load{core::Millimetres{215.0 - 43.0}, core::Millimetres{215.0 + 64.5}};
  const auto stiffening_mm = plate->deflections_mm({load, {}, {}}, core::Newtons{490.0});

  const auto linear = measured_mm(std::string(kExactPoint) + "&plate=linear");
  const auto stiffening = measured_mm(kExactPoint);

  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(linear[i], 490.0 * table->at_point_mm_per_n(i, load), kCodeMm) << i;
    EXPECT_NEAR(stiffening[i], stiffening_mm[i], kCodeMm) << i;
  }
  const Recorded recorded = record(kExactPoint, 100, 5);
  EXPECT_EQ(recorded.channels[kTrueMl].back(), -43.0);
  EXPECT_EQ(recorded.channels[kTrueAp].back(), 64.5);
  EXPECT_EQ(recorded.channels[kTrueLoad].back(), 490.0);
}

TEST(SimFloor, PersonAtTheCentre_BendsTheSensorsAlikeWithinItsSway) {
  const Recorded recorded = record("sim:floor?noise_mv=0&bits=16&gap_spread_mm=0", 100, 20);
  std::array<double, 4> mean{};
  for (std::size_t i = 0; i < mean.size(); ++i) {
    for (std::size_t scan = 500; scan < 2000; ++scan) mean[i] += recorded.channels[i][scan] / 1500;
    EXPECT_GT(mean[i], recorded.channels[i][0] + 1.0);  // 686 N is several tenths of a volt per sensor and more
  }
  const auto [low, high] = std::minmax_element(mean.begin(), mean.end());

  EXPECT_LT(*high - *low, 0.5);
}

TEST(SimFloor, Voltages_AreWholeCodesInRange) {
  for (const auto& [bits, range] : {std::pair{11, 5.0}, std::pair{16, 10.0}, std::pair{12, 2.0}}) {
    const Recorded recorded = record("sim:floor?extra=2&bits=" + std::to_string(bits) + "&range_v=" + std::to_string(range), 200, 8);
    const double step_v = std::ldexp(2.0 * range, -bits);
    for (std::size_t channel = 0; channel < 6; ++channel) {
      for (const double volts : recorded.channels[channel]) {
        ASSERT_NEAR(std::remainder(volts, step_v), 0.0, 1e-9);
        ASSERT_GE(volts, -range);
        ASSERT_LE(volts, range - step_v);
      }
    }
  }
}

TEST(SimFloor, BlockSizeRestartOrLaterChannels_DoNotChangeTheDataButTheSeedDoes) {
  Bench bench("sim:floor");
  bench.start(100);
  const Recorded first = bench.read_scans(600);
  bench.clock.advance_ns(123'456'789);
  (void)bench.device->stop();
  bench.start(100);
  const Recorded second = bench.read_scans(600);
  const Recorded by_one = record("sim:floor", 100, 6, 1);
  const Recorded by_seven = record("sim:floor", 100, 6, 7);
  const Recorded with_extra = record("sim:floor?extra=12", 100, 6);

  for (std::size_t channel = 0; channel < first.channels.size(); ++channel) {
    for (const Recorded* other : {&second, &by_one, &by_seven}) {
      EXPECT_TRUE(same(first.channels[channel], other->channels[channel], 600)) << channel;
    }
    EXPECT_TRUE(channel >= 4 || same(first.channels[channel], with_extra.channels[channel], 600)) << channel;
  }
  const Recorded other_seed = record("sim:floor?seed=2", 100, 6);
  EXPECT_FALSE(same(first.channels[0], other_seed.channels[0], 200));  // noise alone: nobody is there yet
  EXPECT_NE(first.channels[kTrueMl].back(), other_seed.channels[kTrueMl].back());
}

TEST(SimFloor, OtherRate_SameTruthAtTheSameInstants) {
  const Recorded slow = record("sim:floor", 100, 6);
  const Recorded fast = record("sim:floor", 1500, 6);

  for (std::size_t scan = 300; scan < 600; ++scan) {
    EXPECT_NEAR(slow.channels[kTrueMl][scan], fast.channels[kTrueMl][15 * scan], 1e-9);
    EXPECT_NEAR(slow.channels[kTrueAp][scan], fast.channels[kTrueAp][15 * scan], 1e-9);
  }
}

/// First row and duration of a recording, and what the truth channels must show.
struct Rows {
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;

  void centre() {
    for (std::vector<double>* column : {&ml_mm, &ap_mm}) {
      double mean = 0.0;
      for (const double value : *column) mean += value / static_cast<double>(column->size());
      for (double& value : *column) value -= mean;
    }
  }
};

constexpr std::size_t kFirstRowAt100Hz = 450;  // 2.5 s empty, 1.5 s stepping on, 0.5 s settling

void expect_played(const Recorded& recorded, const Rows& rows, double ml_mm, double ap_mm) {
  for (std::size_t i = 0; i < rows.ml_mm.size(); ++i) {
    ASSERT_NEAR(recorded.channels[kTrueMl][kFirstRowAt100Hz + i], ml_mm + rows.ml_mm[i], 1e-9) << i;
    ASSERT_NEAR(recorded.channels[kTrueAp][kFirstRowAt100Hz + i], ap_mm + rows.ap_mm[i], 1e-9) << i;
  }
}

TEST(SimFloor, Recording_AppearsInTheTruthAndThePersonLeavesAtItsEnd) {
  const std::string path = test::temporary_path("recording.csv");
  Rows rows;
  std::ofstream file(path);
  file.precision(17);
  file << "t_s,x_mm,y_mm\n";
  for (int i = 0; i < 300; ++i) {
    rows.ml_mm.push_back(40.0 + 3.0 * std::sin(0.11 * i));
    rows.ap_mm.push_back(-7.0 + 5.0 * std::cos(0.07 * i));
    file << 0.01 * (i + 1) << ',' << rows.ml_mm.back() << ',' << rows.ap_mm.back() << '\n';
  }
  file.close();
  rows.centre();

  const Recorded recorded = record("sim:floor?x_mm=6&y_mm=-4&cop=" + path, 100, 11);
  std::filesystem::remove(path);

  expect_played(recorded, rows, 6.0, -4.0);
  EXPECT_EQ(recorded.channels[kTrueLoad].back(), 0.0);
}

TEST(SimFloor, RealRecording_AppearsInTheTruth) {
  const std::string path = std::string(DTS_SOURCE_DIR) + "/../shared/data/cop/d01_bds00073_young_eo_firm.csv";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no recordings beside this checkout";
  Rows rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    double time_s = 0.0;
    double x = 0.0;
    double y = 0.0;
    char comma = ',';
    cells >> time_s >> comma >> x >> comma >> y;
    rows.ml_mm.push_back(x);
    rows.ap_mm.push_back(y);
  }
  rows.centre();

  const Recorded recorded = record("sim:floor?cop=" + path, 100, 66);

  ASSERT_EQ(rows.ml_mm.size(), 6000U);
  expect_played(recorded, rows, 0.0, 0.0);
}

}  // namespace
}  // namespace dts::device
