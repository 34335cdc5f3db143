// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include <cmath>
#include <string>
#include <vector>

#include "device/sim/chair/emg.h"
#include "device/sim/pacer.h"
#include "sim/chair_rig.h"
#include "support/allocation_counter.h"
#include "unit/device/sim_rig.h"

namespace dts::device::test {
namespace {

constexpr double kRateHz = 100.0;

/// The chair on the bench, and what its channels say.
struct Chair {
  explicit Chair(const std::string& options = "") {
    auto created = create_device(options.empty() ? "sim:chair" : "sim:chair?" + options, {clock, rig});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    device = std::move(*created);
    EXPECT_TRUE(device->open().has_value());
    EXPECT_TRUE(device->start({rate_of(kRateHz), 1}).has_value());
  }

  /// One scan, all channels.
  std::vector<double> scan() {
    core::Block block(device->describe().channels.size(), 1);
    EXPECT_EQ(device->read(block, kNoDeadline).outcome, ReadOutcome::Scans);
    std::vector<double> values;
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) values.push_back(block.column(channel)[0]);
    return values;
  }
  std::vector<std::vector<double>> scans(double seconds) {
    std::vector<std::vector<double>> all;
    for (int i = 0; i < static_cast<int>(seconds * kRateHz); ++i) all.push_back(scan());
    return all;
  }
  [[nodiscard]] std::size_t channel(const std::string& name) const {
    const auto& channels = device->describe().channels;
    const auto found = std::ranges::find(channels, name, &ChannelDescription::name);
    EXPECT_NE(found, channels.end()) << name;
    return static_cast<std::size_t>(found - channels.begin());
  }
  /// Mean deflection of the transient's sensors, mm.
  [[nodiscard]] double transient_mm(const std::vector<double>& values) const {
    double sum = 0.0;
    for (const std::size_t s : {1U, 4U, 9U, 12U}) {
      sum += rig.sensors[s].unloaded_gap.value - rig.sensors[s].curve.gap(core::Volts{values[s]}).value;
    }
    return sum / 4.0;
  }

  core::VirtualClock clock{1'000'000'000'000};
  physics::RigModel rig = dts::sim::chair_rig();
  std::unique_ptr<Device> device;
};

double deviation(const std::vector<std::vector<double>>& scans, std::size_t channel, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += scans[i][channel] * scans[i][channel];
  return std::sqrt(sum / static_cast<double>(to - from));
}

TEST(SimChair, FirstSeconds_TheChairIsEmpty) {
  Chair chair("gap_spread_mm=0&noise_mv=0");
  for (const auto& values : chair.scans(2.4)) {
    EXPECT_NEAR(chair.transient_mm(values), 0.0, 0.005);
    EXPECT_TRUE(std::isnan(values[chair.channel("true_trunk_deg")]));
    EXPECT_EQ(values[chair.channel("true_load_n")], 0.0);
  }
  const auto seated = chair.scans(3.0).back();
  EXPECT_NEAR(seated[chair.channel("true_load_n")], 0.7 * 70.0 * 9.8, 25.0);
  EXPECT_GT(chair.transient_mm(seated), 2.5);
}

TEST(SimChair, MaximumReach_BendsThePlateAsTheSheetSays) {
  Chair chair(
      "weight_kg=68&height_cm=175&arm_length_cm=67&max_reach_cm=124&people_spread=0&fidgets=0&reaches=cued&pace_s=0.75&"
      "gap_spread_mm=0");
  double rest_mm = 0.0;
  for (const auto& values : chair.scans(7.0)) rest_mm = chair.transient_mm(values);
  chair.device->hear({.is_go = true, .at_ns = chair.clock.now_ns(), .target_cm = 124.0});
  double least_mm = rest_mm;
  double most_mm = rest_mm;
  double flexion_deg = 0.0;
  for (const auto& values : chair.scans(4.0)) {
    if (most_mm < rest_mm + 0.5) least_mm = std::min(least_mm, chair.transient_mm(values));
    most_mm = std::max(most_mm, chair.transient_mm(values));
    flexion_deg = std::max(flexion_deg, values[chair.channel("true_trunk_deg")]);
  }

  // Sheet, section 4: P1 3.35, P2 2.47, P3 6.36 for exactly this person at y0 60 mm and this pace; here y0 is 64 mm.
  EXPECT_NEAR(rest_mm, 3.49, 0.2);
  EXPECT_NEAR(least_mm, 2.6, 0.4);
  EXPECT_NEAR(most_mm, 6.4, 0.6);
  EXPECT_NEAR(flexion_deg, 54.9, 6.0);
}

TEST(SimChair, HearsGo_StartsAfterAReactionTimeFromTheCue) {
  Chair chair("reaches=cued&fidgets=0");
  (void)chair.scans(6.0);
  const std::int64_t go_ns = chair.clock.now_ns();
  chair.device->hear({.is_go = false, .at_ns = go_ns - 1000, .target_cm = 120.0});
  chair.device->hear({.is_go = true, .at_ns = go_ns, .target_cm = 120.0});

  const auto scans = chair.scans(3.0);

  const std::size_t trunk = chair.channel("true_trunk_deg");
  std::size_t began = 0;
  while (began < scans.size() && scans[began][trunk] < scans[0][trunk] + 0.2) ++began;
  EXPECT_GE(began, 20U);
  EXPECT_LE(began, 60U) << "0.35 s and the first slow part of the movement";
}

TEST(SimChair, CueOfTheFuture_IsHeardWhenItsTimeHasCome) {
  Chair chair("reaches=cued&fidgets=0");
  (void)chair.scans(6.0);
  chair.device->hear({.is_go = true, .at_ns = chair.clock.now_ns() + 2'000'000'000, .target_cm = 120.0});

  const auto scans = chair.scans(4.0);

  const std::size_t trunk = chair.channel("true_trunk_deg");
  EXPECT_NEAR(scans[210][trunk], scans[0][trunk], 0.1);
  EXPECT_GT(scans[350][trunk], scans[0][trunk] + 10.0);
}

TEST(SimChair, CuesNobodyListensTo_HaveNoEffect) {
  Chair chair("reaches=cued&fidgets=0");
  const Cue go{.is_go = true, .at_ns = chair.clock.now_ns(), .target_cm = 120.0};
  for (int i = 0; i < 100; ++i) chair.device->hear(go);  // more than anybody remembers
  ASSERT_TRUE(chair.device->stop().has_value());
  chair.device->hear(go);
  ASSERT_TRUE(chair.device->start({rate_of(kRateHz), 1}).has_value());

  const std::size_t trunk = chair.channel("true_trunk_deg");
  const auto scans = chair.scans(12.0);
  for (std::size_t i = 500; i < scans.size(); ++i) ASSERT_NEAR(scans[i][trunk], scans[500][trunk], 0.1);
}

TEST(SimChair, Hear_AllocatesNothing) {
  Chair chair;
  (void)chair.scan();
  const std::uint64_t before = dts::test::heap_calls_of_this_thread();
  for (int i = 0; i < 50; ++i) chair.device->hear({.is_go = true, .at_ns = chair.clock.now_ns(), .target_cm = 100.0});
  EXPECT_EQ(dts::test::heap_calls_of_this_thread(), before);
}

TEST(SimChair, Muscles_LiftTheArmAndBrakeTheTrunk) {
  Chair chair("aux=emg&reaches=cued&fidgets=0&pace_s=1&people_spread=0");
  auto scans = chair.scans(7.0);
  chair.device->hear({.is_go = true, .at_ns = chair.clock.now_ns(), .target_cm = 125.0});
  const auto reach = chair.scans(3.0);
  const std::size_t deltoid = chair.channel("emg_ad");
  const std::size_t erector = chair.channel("emg_res");

  EXPECT_GT(deviation(reach, deltoid, 40, 120), 5.0 * deviation(scans, deltoid, 400, 700));
  EXPECT_LT(deviation(reach, erector, 20, 35), 3.0 * deviation(scans, erector, 400, 700)) << "not before the end of the dip";
  EXPECT_GT(deviation(reach, erector, 80, 180), 5.0 * deviation(scans, erector, 400, 700));

  chair.device->hear({.is_go = true, .at_ns = chair.clock.now_ns(), .target_cm = 60.0});
  const auto within = chair.scans(3.0);
  EXPECT_LT(deviation(within, erector, 0, 300), 3.0 * deviation(scans, erector, 400, 700)) << "tonic when the arm alone reaches";
}

TEST(SimChair, Muscles_NoiseOf25To400Hz) {
  const sim::Emg emg(7);
  constexpr int kPerSecond = 4000;
  std::array<double, sim::kEmgChannels> before{};
  double crossings = 0.0;
  for (int i = 0; i <= 10 * kPerSecond; ++i) {
    std::array<double, sim::kEmgChannels> now{};
    emg.write(static_cast<double>(i) / kPerSecond, true, nullptr, now);
    for (std::size_t c = 0; c < now.size(); ++c) crossings += i > 0 && (now[c] < 0.0) != (before[c] < 0.0) ? 1.0 : 0.0;
    before = now;
  }
  // Of noise that is flat between them: the root of the mean square of the frequency, twice a period.
  EXPECT_NEAR(crossings / 2.0 / 10.0 / sim::kEmgChannels, 238.0, 25.0);
}

TEST(SimChair, SameSeed_SameDataAndStandingUpEmptiesTheChair) {
  Chair one("seed=9&stand_up_s=8");
  Chair other("seed=9&stand_up_s=8");
  Chair third("seed=10&stand_up_s=8");
  const auto scans = one.scans(11.0);
  const auto same = other.scans(11.0);
  const auto different = third.scans(11.0);

  EXPECT_EQ(scans[700], same[700]);
  EXPECT_NE(scans[700], different[700]);
  EXPECT_EQ(scans.back()[one.channel("true_load_n")], 0.0);
  EXPECT_NEAR(scans.back()[1], scans.front()[1], 0.03);
}

// Cues come in host time, the person lives in the device's.
TEST(SimChair, HostTimeOfAScan_IsItsTimeOnTheDevicesClock) {
  for (const double clock_error_ppm : {0.0, 1000.0, -300.0}) {
    const sim::Pacer pacer(1'000'000, rate_of(kRateHz), clock_error_ppm);
    EXPECT_NEAR(pacer.device_time_s(pacer.instant_ns(100'000)), 1000.0, 1e-6);
  }
}

TEST(SimChair, ChildAndHeavyPerson_StayFinite) {
  for (const char* weight : {"weight_kg=20&height_cm=115&arm_length_cm=40&max_reach_cm=70", "weight_kg=130", "weight_kg=250"}) {
    Chair chair(weight);
    for (const auto& values : chair.scans(30.0)) {
      for (std::size_t s = 0; s < 16; ++s) ASSERT_TRUE(std::isfinite(values[s]));
    }
  }
}

}  // namespace
}  // namespace dts::device::test
