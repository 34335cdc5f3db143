// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/stiffening_plate.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "physics/plate/influence_table.h"
#include "physics/plate/solve.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::at;
using test::corners;
using test::floor_sensors;
using test::steel_plate;

/// Feet, as the simulated person has them.
const std::vector<Patch> kFeet = {{.centre = at(115, 215), .width = {80.0}, .height = {240.0}},
                                  {.centre = at(315, 215), .width = {80.0}, .height = {240.0}}};

/// The steel platform with the four sensors that the thesis gives it.
const StiffeningPlate& steel() {
  static const StiffeningPlate kPlate = StiffeningPlate::create(steel_plate(), corners(10.75), floor_sensors()).value();
  return kPlate;
}

std::vector<double> full_solution_mm(const Plate& plate, const Support& support, const std::vector<PlateLoad>& loads) {
  const auto solution = solve({plate, support, loads, floor_sensors()}, PlateMethod::Fdm, {.divisions = 40, .is_nonlinear = true});
  EXPECT_TRUE(solution);
  std::vector<double> deflections_mm;
  for (const auto& probe : solution->probes) deflections_mm.push_back(probe.deflection_mm);
  return deflections_mm;
}

TEST(StiffeningPlate, PointLoads_AreWithinSevenThousandthsOfTheFullSolution) {
  double largest = 0.0;
  for (const auto& [load, force_n] : {std::pair{at(215, 215), 720.0}, {at(86, 86), 720.0}, {at(330, 120), 420.0}, {at(95, 300), 120.0}}) {
    const auto expected = full_solution_mm(steel_plate(), corners(10.75), {{.area = {.centre = load}, .force = {force_n}}});
    const auto found = steel().deflections_mm({.centre = load}, {force_n});
    for (std::size_t k = 0; k < found.size(); ++k) largest = std::max(largest, std::abs(found[k] / expected[k] - 1.0));
  }
  EXPECT_LT(largest, 0.007);
  EXPECT_GT(largest, 0.0);  // it is a reduction, not the solution itself
}

TEST(StiffeningPlate, TwoFeet_AreWithinThreeThousandthsOfTheFullSolution) {
  const std::array footprints{steel().footprint(kFeet[0]), steel().footprint(kFeet[1])};
  const std::array force_n{500.0, 300.0};
  auto state = steel().flat();
  std::vector<double> found(4);
  steel().deflect(footprints, force_n, state, found);

  const auto expected = full_solution_mm(steel_plate(), corners(10.75), {{kFeet[0], {force_n[0]}}, {kFeet[1], {force_n[1]}}});

  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k] / expected[k], 1.0, 0.003);
}

TEST(StiffeningPlate, SmallLoad_IsTheLinearPlate) {
  const auto table = InfluenceTable::create(steel_plate(), corners(10.75), floor_sensors());
  ASSERT_TRUE(table);
  const auto found = steel().deflections_mm({.centre = at(130, 260)}, {0.1});
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k] / (0.1 * table->at_point_mm_per_n(k, at(130, 260))), 1.0, 1e-6);
}

TEST(StiffeningPlate, EdgeSupported_StiffensToo) {
  Plate thin = steel_plate();
  thin.h = {1.0};
  const Support support = test::edges();
  const auto plate = StiffeningPlate::create(thin, support, floor_sensors());
  ASSERT_TRUE(plate);
  const auto found = plate->deflections_mm(kFeet[0], {60.0});
  const auto expected = full_solution_mm(thin, support, {{kFeet[0], {60.0}}});
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k] / expected[k], 1.0, 0.01) << k;
}

TEST(StiffeningPlate, History_DoesNotMatter) {
  // The start only decides how many rounds it takes.
  const std::array footprints{steel().footprint({.centre = at(215, 215)})};
  auto state = steel().flat();
  std::vector<double> found(4);
  for (const double force_n : {2000.0, -300.0, 0.0, 490.0}) steel().deflect(footprints, std::array{force_n}, state, found);
  const auto fresh = steel().deflections_mm({.centre = at(215, 215)}, {490.0});
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], fresh[k], 1e-7);
}

TEST(StiffeningPlate, HeavyLoadPutDownAtOnce_IsThatPutDownGradually) {
  // Newton's method in one stride from the flat plate found another equilibrium for one load in seventy.
  for (double x_mm = 70.0; x_mm <= 360.0; x_mm += 41.3) {
    for (double y_mm = 70.0; y_mm <= 360.0; y_mm += 47.7) {
      const std::array footprints{steel().footprint({.centre = at(x_mm, y_mm)})};
      auto state = steel().flat();
      std::vector<double> gradual(4);
      for (double force_n = 50.0; force_n <= 1300.0; force_n += 50.0) steel().deflect(footprints, std::array{force_n}, state, gradual);
      const auto at_once = steel().deflections_mm({.centre = at(x_mm, y_mm)}, {1300.0});
      for (std::size_t k = 0; k < gradual.size(); ++k) EXPECT_NEAR(at_once[k], gradual[k], 1e-6) << x_mm << ", " << y_mm;
    }
  }
}

TEST(StiffeningPlate, LoadPutDownElsewhere_IsAsIfThePlateHadBeenEmpty) {
  // On a thin plate the old equilibrium is a bad start: followed from there, every third such move used to end metres away.
  const Plate thin{.a = {430.0}, .b = {430.0}, .h = {4.0}, .e_pa = 3.5e9, .nu = 0.31};
  const auto plate = StiffeningPlate::create(thin, corners(10.75), floor_sensors());
  ASSERT_TRUE(plate);
  std::vector<StiffeningPlate::Footprint> places;
  for (const Point& place : {at(54, 184), at(189, 183), at(394, 90), at(217, 263), at(80, 400)})
    places.push_back(plate->footprint({.centre = place}));
  for (std::size_t from = 0; from < places.size(); ++from) {
    for (std::size_t to = 0; to < places.size(); ++to) {
      auto used = plate->flat();
      auto fresh = plate->flat();
      std::vector<double> moved(4);
      std::vector<double> expected(4);
      plate->deflect(std::span(&places[from], 1), std::array{490.0}, used, moved);
      plate->deflect(std::span(&places[to], 1), std::array{490.0}, used, moved);
      plate->deflect(std::span(&places[to], 1), std::array{490.0}, fresh, expected);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(moved[k], expected[k], 1e-4) << from << " to " << to;
    }
  }
}

TEST(StiffeningPlate, LoadThatWandersAcross_StaysOnAnEquilibrium) {
  // 2000 N moved within 50 scans: bistable places may differ from a load put down there by tenths of a millimetre, no more.
  const std::array places{steel().footprint({.centre = at(54, 184)}), steel().footprint({.centre = at(189, 183)})};
  auto state = steel().flat();
  std::vector<double> wandered(4);
  for (int step = 0; step <= 50; ++step) steel().deflect(places, std::array{2000.0 - 40.0 * step, 40.0 * step}, state, wandered);
  const auto expected = steel().deflections_mm({.centre = at(189, 183)}, {2000.0});
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(wandered[k], expected[k], 0.3);
}

TEST(StiffeningPlate, NotANumber_DoesNotStayInTheState) {
  const std::array place{steel().footprint({.centre = at(150, 180)})};
  auto state = steel().flat();
  std::vector<double> found(4);
  for (const double force_n : {-2000.0, std::numeric_limits<double>::quiet_NaN(), 500.0})
    steel().deflect(place, std::array{force_n}, state, found);
  const auto expected = steel().deflections_mm({.centre = at(150, 180)}, {500.0});
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k], expected[k], 1e-6);
  for (const double deflection_mm : steel().deflections_mm({.centre = at(215, 215)}, {1e6})) EXPECT_TRUE(std::isfinite(deflection_mm));
}

TEST(StiffeningPlate, BadInput_IsRefusedAsByTheTable) {
  EXPECT_FALSE(StiffeningPlate::create(steel_plate(), corners(10.75), {}));
  EXPECT_FALSE(StiffeningPlate::create(steel_plate(), corners(214.9999), floor_sensors()));
  EXPECT_FALSE(StiffeningPlate::create(steel_plate(), corners(10.75), floor_sensors(), 2));
}

}  // namespace
}  // namespace dts::physics
