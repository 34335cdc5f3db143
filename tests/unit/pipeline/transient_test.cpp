// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/transient.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include "core/special_numbers.h"
#include "unit/pipeline/chair_chain.h"

namespace dts::pipeline {
namespace {

using core::kNaN;

/// Deflections that wobble by more than a code of the converter, so that no channel stands still.
Signal steady(std::vector<double> levels_mm, std::size_t scans) {
  std::vector<std::vector<double>> columns;
  for (const double level_mm : levels_mm) {
    columns.emplace_back();
    for (std::size_t i = 0; i < scans; ++i) columns.back().push_back(level_mm + (i % 2 == 0 ? 0.001 : -0.001));
  }
  return make_signal(100.0, "mm", columns);
}

TEST(Transient, FourGoodSensors_GiveMeanRatioAndTwist) {
  RecordProperty("requirement", "REACH-1");
  const Signal out = transient_from(steady({4.0, 4.4, 3.0, 3.2}, 20));

  EXPECT_NEAR(out.values[0][10], 3.65, 0.002);
  EXPECT_NEAR(out.values[1][10], (3.1 - 4.2) / 3.65, 0.001);
  EXPECT_NEAR(out.values[2][10], ((4.0 - 4.4) - (3.0 - 3.2)) / 3.65, 0.001);
  EXPECT_EQ(out.bits[0][10], 0);
  EXPECT_EQ(out.format.channels[1].unit, "1");
}

TEST(Transient, EmptySeat_IsFiniteWithoutContact) {
  const Signal out = transient_from(steady({0.0, 0.0, 0.0, 0.0}, 20));

  EXPECT_TRUE(std::isfinite(out.values[1][10]));
  EXPECT_EQ(out.bits[0][10], core::quality::kNoContact);
}

TEST(Transient, OneWildValue_LeavesNoTrace) {
  Signal in = steady({4.0, 4.0, 3.0, 3.0}, 40);
  in.values[2][20] = -3.3;

  const Signal out = transient_from(in);

  for (std::size_t i = 10; i < 40; ++i) EXPECT_NEAR(out.values[0][i], 3.5, 0.002) << i;
  EXPECT_EQ(out.bits[0][20], 0);
}

TEST(Transient, StepOfTheSeat_IsFollowedWithinThreeScans) {
  Signal in = steady({4.0, 4.0, 3.0, 3.0}, 40);
  for (auto& column : in.values) std::for_each(column.begin() + 20, column.end(), [](double& mm) { mm += 1.0; });

  const Signal out = transient_from(in);

  EXPECT_NEAR(out.values[0][23], 4.5, 0.002);
}

TEST(Transient, SensorThatDies_IsReplacedByItsPartnersChange) {
  RecordProperty("requirement", "REACH-1");
  Signal in = steady({4.0, 4.2, 3.0, 3.1}, 400);
  for (std::size_t i = 200; i < 400; ++i) {
    in.values[0][i] = kNaN;
    in.bits[0][i] = core::quality::kRail;
    for (std::size_t c = 1; c < 4; ++c) in.values[c][i] += c == 1 ? 0.4 : 0.8;  // the rows move by different amounts
  }

  const Signal out = transient_from(in);

  EXPECT_NEAR(out.values[0][199], 3.575, 0.002);
  EXPECT_NEAR(out.values[0][300], 3.575 + (0.4 + 0.4 + 0.8 + 0.8) / 4.0, 0.005);
  EXPECT_EQ(out.bits[0][300], core::quality::kSubstituted | core::quality::kUncalibrated);
}

TEST(Transient, SensorThatStandsStill_IsReplacedAfterFiftyMilliseconds) {
  Signal in = steady({4.0, 4.0, 3.0, 3.0}, 400);
  for (std::size_t i = 200; i < 400; ++i) in.values[3][i] = 3.0;

  const Signal out = transient_from(in);

  // The converter of the test has 11 bit: by chance it gives the same code 27 times before anything is wrong.
  EXPECT_EQ(out.bits[0][225], 0);
  EXPECT_EQ(out.bits[0][226], core::quality::kSubstituted);
}

TEST(Transient, SensorDeadFromTheBeginning_FollowsItsPartner) {
  Signal in = steady({4.0, 4.2, 3.0, 3.1}, 50);
  std::ranges::fill(in.bits[0], core::quality::kOutOfRange);

  const Signal out = transient_from(in);

  EXPECT_NEAR(out.values[0][20], (4.2 + 4.2 + 3.0 + 3.1) / 4.0, 0.002);
  EXPECT_NE(out.bits[0][20] & core::quality::kSubstituted, 0);
}

TEST(Transient, WholeRowDeadFromTheBeginningOrThreeLater_IsNaNWithTheReason) {
  for (const auto& [dead, from] : {std::pair{2U, 0}, {3U, 50}}) {
    Signal in = steady({4.0, 4.2, 3.0, 3.1}, 100);
    for (std::size_t c = 0; c < dead; ++c) std::fill(in.bits[c].begin() + from, in.bits[c].end(), core::quality::kRail);

    const Signal out = transient_from(in);

    for (int i = 0; i < 100; ++i) EXPECT_EQ(std::isnan(out.values[0][static_cast<std::size_t>(i)]), i >= from) << dead << ", " << i;
    EXPECT_EQ(out.bits[0][60], core::quality::kRail);
  }
}

TEST(Transient, Untared_PassesThrough) {
  Signal in = steady({4.0, 4.0, 3.0, 3.0}, 20);
  for (auto& bits : in.bits) std::ranges::fill(bits, core::quality::kUntared);

  EXPECT_EQ(transient_from(in).bits[0][10], core::quality::kUntared);
}

TEST(Transient, SensorsInAnyOrder_AreSortedByPlace) {
  const std::array<double, 4> mm = {4.0, 4.4, 3.0, 3.2};
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  do {
    physics::RigModel rig = chair_rig();
    std::vector<double> levels_mm;
    for (std::size_t i = 0; i < 4; ++i) {
      rig.sensors[i] = chair_rig().sensors[order[i]];
      levels_mm.push_back(mm[order[i]]);
    }
    StageSurroundings surroundings(std::move(rig));
    const auto stage = surroundings.make({.id = "transient", .options = {}});

    const Output out = prepare_and_run(*stage, steady(levels_mm, 20));

    EXPECT_NEAR(out.values[1][10], (3.1 - 4.2) / 3.65, 0.001);
    EXPECT_NEAR(out.values[2][10], ((4.0 - 4.4) - (3.0 - 3.2)) / 3.65, 0.001);
  } while (std::ranges::next_permutation(order).found);
}

TEST(Transient, RigThatNamesItsSensors_UsesThese) {
  physics::RigModel rig = chair_rig();
  rig.sensors.push_back(rig.sensors.front());
  rig.transient_sensors = {.rear = {1, 4}, .front = {2, 3}};
  StageSurroundings surroundings(std::move(rig));
  const auto stage = surroundings.make({.id = "transient", .options = {}});

  const Output out = prepare_and_run(*stage, steady({9.0, 4.0, 3.0, 3.0, 4.0}, 20));

  EXPECT_NEAR(out.values[0][10], 3.5, 0.002);
}

}  // namespace
}  // namespace dts::pipeline
