// SPDX-License-Identifier: Apache-2.0
#include "sim/seat_load.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "physics/body/person.h"
#include "sim/chair_rig.h"
#include "sim/seat_plate.h"
#include "unit/physics/body/reference_rows.h"
#include "unit/physics/body/volunteer_a.h"

namespace dts::sim {
namespace {

constexpr double kPhaseS = 0.75;

SeatPlate four_probes() {
  const physics::RigModel rig = chair_rig();
  const auto& used = *rig.transient_sensors;
  const std::array probes = {rig.sensors[used.rear[0]].position, rig.sensors[used.rear[1]].position, rig.sensors[used.front[0]].position,
                             rig.sensors[used.front[1]].position};
  return SeatPlate::create(rig.plate, rig.support, probes, {}).value();
}

/// As the fixtures were made: y0 60 mm, lambda 0.10.
SeatedBody fixture_body(double weight_kg, double height_cm, SeatLoadModel model) {
  return SeatedBody({.model = model, .weight_kg = weight_kg, .height_cm = height_cm, .rest_y_mm = 60.0, .moment_to_feet = 0.10});
}

SeatLoad load_at(const SeatedBody& body, double time_s, double flexion_deg) {
  const double lift = back_rest_lift(time_s, 2.0 * kPhaseS, flexion_deg, body.parameters().lifting_deg);
  return body.load(body.on_the_way(there_and_back(time_s, kPhaseS), flexion_deg, true), lift);
}

void expect_near_relative(double value, double expected, double part) { EXPECT_NEAR(value, expected, part * std::abs(expected)); }

TEST(SeatPlate, EdgeSupported_AsTheFixture) {
  const auto rows = physics::test::reference_rows("plate_ss.csv");
  if (rows.empty()) GTEST_SKIP() << "no " << physics::test::reference_folder();
  const SeatPlate plate = four_probes();

  for (const auto& row : rows) {
    const bool is_uniform = row.at("yc_mm") == "UDL";
    std::array<double, 4> mm{};
    plate.deflect({.force_n = 480.0, .y_mm = is_uniform ? 0.0 : physics::test::number(row, "yc_mm"), .is_uniform = is_uniform}, mm);
    for (std::size_t k = 0; k < 4; ++k) expect_near_relative(mm[k], physics::test::number(row, "w" + std::to_string(k + 1)), 1e-4);
  }
}

void expect_transient(const std::string& condition, double flexion_deg, SeatLoadModel model, const std::string& name) {
  const auto rows = physics::test::reference_rows("ideal_A_" + condition + "_" + name + ".csv");
  if (rows.empty()) GTEST_SKIP() << "no " << physics::test::reference_folder();
  const SeatPlate plate = four_probes();
  const SeatedBody body = fixture_body(68.0, 175.0, model);
  for (const auto& row : rows) {
    SCOPED_TRACE(condition + " " + name + " " + row.at("t_s"));
    const SeatLoad load = load_at(body, physics::test::number(row, "t_s"), flexion_deg);
    std::array<double, 4> mm{};
    plate.deflect(load, mm);
    expect_near_relative(load.force_n, physics::test::number(row, "F_N"), 0.005);
    for (std::size_t k = 0; k < 4; ++k) expect_near_relative(mm[k], physics::test::number(row, "w" + std::to_string(k + 1)), 0.005);
  }
}

TEST(SeatLoad, IdealReaches_AsTheFixtures) {
  for (const auto& [condition, target_cm] : {std::pair{"120", 1.2 * 67.0}, std::pair{"150", 1.5 * 67.0}, std::pair{"max", 124.0}}) {
    expect_transient(condition, physics::trunk_flexion_deg(physics::test::kVolunteerA, target_cm), SeatLoadModel::Cop, "cop");
    expect_transient(condition, physics::trunk_flexion_deg(physics::test::kVolunteerA, target_cm), SeatLoadModel::Thesis, "thesis");
  }
}

TEST(SeatLoad, IdealReaches_FeaturesAsTheFixture) {
  const auto rows = physics::test::reference_rows("ideal_features.csv");
  if (rows.empty()) GTEST_SKIP() << "no " << physics::test::reference_folder();
  const SeatPlate plate = four_probes();
  const std::map<std::string, std::pair<double, double>> people = {{"A", {68.0, 175.0}}, {"B", {52.0, 165.0}}, {"C", {81.0, 182.0}}};
  for (const auto& row : rows) {
    SCOPED_TRACE(row.at("volunteer") + " " + row.at("condition") + " " + row.at("model"));
    const auto [weight_kg, height_cm] = people.at(row.at("volunteer"));
    const SeatedBody body = fixture_body(weight_kg, height_cm, row.at("model") == "cop" ? SeatLoadModel::Cop : SeatLoadModel::Thesis);
    const auto transient_mm = [&](double time_s) {
      std::array<double, 4> mm{};
      plate.deflect(load_at(body, time_s, physics::test::number(row, "phi_deg")), mm);
      return (mm[0] + mm[1] + mm[2] + mm[3]) / 4.0;
    };
    double most_mm = 0.0;
    double most_s = 0.0;
    for (double t = 0.0; t <= kPhaseS; t += 0.001) {
      if (transient_mm(t) <= most_mm) continue;
      most_mm = transient_mm(t);
      most_s = t;
    }
    double least_mm = most_mm;
    for (double t = -0.1; t < most_s; t += 0.001) least_mm = std::min(least_mm, transient_mm(t));
    expect_near_relative(transient_mm(-0.5), physics::test::number(row, "P1"), 0.005);
    expect_near_relative(least_mm, physics::test::number(row, "P2"), 0.005);
    expect_near_relative(most_mm, physics::test::number(row, "P3"), 0.005);
  }
}

TEST(SeatLoad, AtRest_IsThePartOfTheWeight) {
  for (const SeatLoadModel model : {SeatLoadModel::Cop, SeatLoadModel::Thesis}) {
    const SeatedBody body = fixture_body(70.0, 175.0, model);
    const SeatLoad load = body.load(body.at_rest(), 0.0);
    EXPECT_NEAR(load.force_n, 0.7 * 70.0 * 9.8, 1e-9);
    if (!load.is_uniform) {
      EXPECT_NEAR(load.y_mm, 60.0, 1e-9);
    }
  }
  const SeatedBody everybody({.model = SeatLoadModel::Thesis, .rest_force_n = 480.0});
  EXPECT_NEAR(everybody.load(everybody.at_rest(), 0.0).force_n, 480.0, 1e-9);
}

TEST(SeatLoad, LettingGoOfTheBackRest_MovesTheLoadBack) {
  const SeatedBody leaning = fixture_body(70.0, 175.0, SeatLoadModel::Cop);
  EXPECT_LT(leaning.load(leaning.at_rest(), 1.0).y_mm, 60.0 - 5.0);

  const SeatedBody upright({.lean_back_deg = 0.0, .rest_y_mm = 60.0});
  EXPECT_NEAR(upright.load(upright.at_rest(), 1.0).y_mm, 60.0, 1e-9) << "nothing to let go";
}

TEST(SeatPlate, LoadInTheMiddleOfTheWidth_BendsMirrorPairsAlike) {
  const SeatPlate plate = four_probes();
  for (double y_mm = -120.0; y_mm <= 480.0; y_mm += 7.3) {
    std::array<double, 4> mm{};
    plate.deflect({.force_n = 500.0, .y_mm = y_mm}, mm);
    EXPECT_NEAR(mm[0], mm[1], 1e-9);
    EXPECT_NEAR(mm[2], mm[3], 1e-9);
    EXPECT_GE(mm[0], -1e-6);
  }
}

TEST(SeatPlate, SeriesAndGrid_SeeTheSamePlate) {
  const physics::RigModel rig = chair_rig();
  const std::array probes = {rig.sensors[1].position, rig.sensors[9].position};
  const SeatPlate series = SeatPlate::create(rig.plate, rig.support, probes, {}).value();
  const SeatPlate grid = SeatPlate::create(rig.plate, {.kind = physics::SupportKind::Clamped}, probes, {}).value();
  std::array<double, 2> free_mm{};
  std::array<double, 2> held_mm{};

  series.deflect({.force_n = 480.0, .y_mm = 130.0}, free_mm);
  grid.deflect({.force_n = 480.0, .y_mm = 130.0}, held_mm);

  EXPECT_LT(held_mm[0], 0.5 * free_mm[0]) << "held without slope it bends far less";
  EXPECT_GT(held_mm[0], 0.1 * free_mm[0]);
}

TEST(SeatPlate, NonsenseContactOrProbe_Refused) {
  const physics::RigModel rig = chair_rig();
  const std::array outside = {physics::Point{core::Millimetres{-1.0}, core::Millimetres{10.0}}};
  EXPECT_FALSE(SeatPlate::create(rig.plate, rig.support, outside, {}).has_value());
  EXPECT_FALSE(SeatPlate::create(rig.plate, rig.support, {}, {.width_mm = 0.0}).has_value());
  EXPECT_FALSE(SeatPlate::create(rig.plate, rig.support, {}, {.depth_mm = std::nan("")}).has_value());
}

}  // namespace
}  // namespace dts::sim
