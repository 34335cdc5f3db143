// SPDX-License-Identifier: Apache-2.0
// What the two parts of sim:stack share: the person, the true time and the sync signal, and what each makes of them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "physics/force_plate/wrench.h"
#include "unit/device/sim_rig.h"

namespace dts::device {
namespace {

using test::Recorded;

constexpr double kRateHz = 100.0;
constexpr std::int64_t kSecondNs = core::kNanosecondsPerSecond;

/// Two parts on one host clock.
struct Stack {
  std::unique_ptr<Device> create(const std::string& uri) {
    auto created = create_device(uri, {clock, rig});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    return created ? std::move(*created) : nullptr;
  }

  /// Starts the device now and reads so many scans: by channel.
  std::vector<std::vector<double>> record(Device& device, std::size_t scans) {
    EXPECT_TRUE(device.open().has_value());
    EXPECT_TRUE(device.start({test::rate_of(kRateHz), 64}).has_value());
    core::Block block(device.describe().channels.size(), 64);
    std::vector<std::vector<double>> channels(block.channel_count());
    while (channels[0].size() < scans) {
      if (device.read(block, test::kNoDeadline).outcome != ReadOutcome::Scans) break;
      for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        const auto column = block.column(channel);
        channels[channel].insert(channels[channel].end(), column.begin(), column.end());
      }
    }
    for (auto& channel : channels) channel.resize(scans);
    EXPECT_TRUE(device.stop().has_value());
    return channels;
  }

  core::VirtualClock clock{1'000 * kSecondNs};
  physics::RigModel rig = test::stack_rig();
};

std::size_t channel_of(const Device& device, const std::string& name) {
  const auto& channels = device.describe().channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name == name) return i;
  }
  ADD_FAILURE() << "no channel " << name;
  return 0;
}

std::vector<std::size_t> rising_edges(const std::vector<double>& volts) {
  std::vector<std::size_t> edges;
  for (std::size_t i = 1; i < volts.size(); ++i) {
    if (volts[i - 1] < 2.5 && volts[i] >= 2.5) edges.push_back(i);
  }
  return edges;
}

TEST(SimStack, PartsStartedAtDifferentMoments_ShowThePersonAtTheSameTrueTime) {
  Stack stack;
  const auto floor = stack.create("sim:stack?seed=7");
  const auto plate = stack.create("sim:stack?part=plate&seed=7");
  const auto scan_now = [&] {  // of a device that started at true time 0; the virtual clock stands at the last scan that was read
    return static_cast<std::size_t>(std::llround(static_cast<double>(stack.clock.now_ns() - 1'000 * kSecondNs) / kSecondNs * kRateHz));
  };
  const auto on_floor = stack.record(*floor, 1200);
  const std::size_t plate_first = scan_now();
  const auto on_plate = stack.record(*plate, 800);
  const std::size_t again_first = scan_now();
  const auto again_on_floor = stack.record(*floor, 300);

  // Another stack, whose floor part runs from true time 0 without a break, says what they must have shown.
  Stack same;
  const auto whole = same.create("sim:stack?seed=7");
  const auto expected = same.record(*whole, 2600);
  for (const char* name : {"true_ml_mm", "true_ap_mm", "true_fx_n", "true_fy_n", "true_load_n"}) {
    const auto& wanted = expected[channel_of(*whole, name)];
    const auto& found = on_plate[channel_of(*plate, name)];
    for (std::size_t i = 0; i < found.size(); i += 50) EXPECT_NEAR(found[i], wanted[plate_first + i], 1e-6) << name << " " << i;
    const auto& again = again_on_floor[channel_of(*floor, name)];
    for (std::size_t i = 0; i < again.size(); i += 50) EXPECT_NEAR(again[i], wanted[again_first + i], 1e-6) << name << " " << i;
  }
  EXPECT_TRUE(std::isnan(on_floor[channel_of(*floor, "true_ml_mm")][0]));  // steps on at 2.5 s of true time
}

TEST(SimStack, Sync_RisesAtEachWholeSecondOfTrueTimeOnEachClock) {
  Stack stack;
  const auto exact = stack.create("sim:stack?seed=7");
  const auto off = stack.create("sim:stack?part=plate&seed=7&clock_ppm=1000&offset_s=0.3");
  const auto edges = rising_edges(stack.record(*exact, 1000)[channel_of(*exact, "sync")]);
  ASSERT_GE(edges.size(), 9U);
  for (const std::size_t edge : edges) EXPECT_EQ(edge % 100, 0U);

  Stack alone;
  const auto late = alone.create("sim:stack?part=plate&seed=7&clock_ppm=1000&offset_s=0.3");
  const auto shifted = rising_edges(alone.record(*late, 12'000)[channel_of(*late, "sync")]);
  EXPECT_EQ(shifted.front(), 31U);                // 0.3 s later, and the next scan of a clock that is fast
  EXPECT_EQ(shifted[100] - shifted[0], 10'010U);  // 1000 ppm in 100 s are 0.1 s
}

TEST(SimStack, Plate_MeansTheTrueForceAndTheCopAtTheTopOfThePlatform) {
  Stack stack;
  const auto plate = stack.create("sim:stack?part=plate&seed=5&height_mm=80&cross_talk=0&drift_n_per_min=0&noise_mv=0&contact=one_foot");
  const auto channels = stack.record(*plate, 1500);
  const physics::ForcePlateModel& model = *stack.rig.force_plate;
  const auto truth = [&](const char* name, std::size_t scan) { return channels[channel_of(*plate, name)][scan]; };
  for (std::size_t scan = 600; scan < 1500; scan += 100) {
    std::vector<double> volts;
    for (std::size_t i = 0; i < 8; ++i) volts.push_back(channels[i][scan] - model.tare_v[i]);
    const physics::Wrench surface = physics::in_subject_frame(model.plate.wrench(volts), model.mounting);
    const physics::ForcePoint top = physics::force_point(physics::about(surface, {0.0, 0.0, 80.0}));
    EXPECT_NEAR(surface.force_n[0], truth("true_fx_n", scan), 0.02);  // half a code is 0.15 mV, 0.004 N of shear
    EXPECT_NEAR(surface.force_n[1], truth("true_fy_n", scan), 0.02);
    EXPECT_NEAR(surface.force_n[2], truth("true_load_n", scan), 0.2);
    EXPECT_NEAR(top.x_mm, truth("true_ml_mm", scan), 0.05);
    EXPECT_NEAR(top.y_mm, truth("true_ap_mm", scan), 0.05);
  }
}

TEST(SimStack, DriftAndCrossTalk_AreAsLargeAsAsked) {
  Stack stack;
  const auto vertical = [&](const std::vector<std::vector<double>>& channels, std::size_t scan) {
    std::vector<double> volts;
    for (std::size_t i = 0; i < 8; ++i) volts.push_back(channels[i][scan] - stack.rig.force_plate->tare_v[i]);
    return physics::in_subject_frame(stack.rig.force_plate->plate.wrench(volts), stack.rig.force_plate->mounting).force_n;
  };
  const auto empty = stack.create("sim:stack?part=plate&noise_mv=0&drift_n_per_min=60&step_on_s=1000");
  const auto creeping = stack.record(*empty, 1000);
  EXPECT_NEAR(std::abs(vertical(creeping, 999)[2] - vertical(creeping, 0)[2]), 9.99, 0.2);

  double largest = 0.0;
  for (int seed = 1; seed <= 5; ++seed) {
    const auto talking =
        stack.create("sim:stack?part=plate&noise_mv=0&drift_n_per_min=0&cross_talk=0.02&step_on_s=0&seed=" + std::to_string(seed));
    const auto channels = stack.record(*talking, 600);
    const double shear_n = vertical(channels, 599)[0] - channels[channel_of(*talking, "true_fx_n")][599];
    EXPECT_LT(std::abs(shear_n), 0.02 * 700.0);
    largest = std::max(largest, std::abs(shear_n));
  }
  EXPECT_GT(largest, 3.0);
}

TEST(SimStack, Shear_IsWhatTheCopOfThePendulumRequires) {
  Stack stack;
  const auto floor = stack.create("sim:stack?seed=9&weight_n=700");
  const auto channels = stack.record(*floor, 6000);
  const auto& cop = channels[channel_of(*floor, "true_ap_mm")];
  const auto& shear = channels[channel_of(*floor, "true_fy_n")];
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 1000; i < 6000; ++i) {
    sum += shear[i];
    squares += shear[i] * shear[i];
  }
  EXPECT_NEAR(sum / 5000.0, 0.0, 0.1);  // the centre of mass does not fly away
  const double rms_n = std::sqrt(squares / 5000.0);
  EXPECT_GT(rms_n, 0.2);  // 0.45 to 1.0 N in recordings of quiet standing
  EXPECT_LT(rms_n, 1.2);
  // m x'' = m g (x - p) / l: where the COP is far forward, the ground pushes backwards.
  double product = 0.0;
  for (std::size_t i = 1000; i < 6000; ++i) product += shear[i] * (cop[i] - cop[i - 50]);
  EXPECT_LT(product, 0.0);
}

TEST(SimStack, RigOfTheOtherKind_IsRefused) {
  core::VirtualClock clock;
  const physics::RigModel floor = test::floor_rig();
  const auto refused = create_device("sim:stack?part=plate", {clock, floor});
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(core::to_string(refused.error()).find("part=plate needs a rig with [force_plate]"), std::string::npos);
  physics::RigModel plate = test::stack_rig();
  plate.sensors.clear();
  const auto other = create_device("sim:stack", {clock, plate});
  ASSERT_FALSE(other.has_value());
  EXPECT_NE(core::to_string(other.error()).find("part=floor needs a rig with sensors"), std::string::npos);
}

}  // namespace
}  // namespace dts::device
