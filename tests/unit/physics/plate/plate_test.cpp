// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/influence_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "physics/plate/solve.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::acrylic_plate;
using test::at;
using test::corners;
using test::edges;
using test::kGravity;
using test::RefinedPlate;
using test::steel_plate;

const Point kCentre = at(215, 215);

InfluenceTable table(const Plate& plate, const Support& support, const std::vector<Point>& probes,
                     int divisions = InfluenceTable::kDefaultDivisions) {
  return *InfluenceTable::create(plate, support, probes, divisions);
}

void expect_within(double value, double reference, double percent, const char* what) {
  EXPECT_NEAR(value, reference, std::abs(reference) * percent / 100.0) << what;
}

/// Verification positions of thesis Fig. 3.7 (plate-model section 3).
std::vector<Point> verification_positions(double s_mm) { return {at(s_mm, s_mm), at(215, s_mm), kCentre}; }

TEST(InfluenceTable, CentralLoad_MatchesTheFiniteElementColumnsOfTables32And33) {
  EXPECT_NEAR(steel_plate().rigidity_nm(), 482.23, 0.005);
  EXPECT_NEAR(acrylic_plate().rigidity_nm(), 20.65, 0.005);
  const auto expect = [](const Plate& plate, double inset_mm, double s_mm, double load_n, std::array<double, 3> expected_mm,
                         std::array<double, 3> percent) {
    const RefinedPlate refined(plate, corners(inset_mm), verification_positions(s_mm));
    for (std::size_t k = 0; k < 3; ++k) {
      expect_within(load_n * refined.under_point(k, kCentre), expected_mm[k], percent[k], ("sensor " + std::to_string(k + 1)).c_str());
    }
  };
  expect(acrylic_plate(), 0.0, 86.0, kGravity, {2.030, 2.709, 3.430}, {1.0, 0.5, 0.3});
  expect(acrylic_plate(), 0.0, 85.3, kGravity, {2.030, 2.709, 3.430}, {0.2, 0.2, 0.3});
  expect(steel_plate(), 10.75, 86.0, 20.0 * kGravity, {1.3675, 1.886, 2.466}, {2.5, 1.0, 0.8});
  expect(steel_plate(), 10.9, 88.4, 20.0 * kGravity, {1.3675, 1.886, 2.466}, {0.3, 0.3, 0.3});
}

TEST(InfluenceTable, AnyLoad_IsSolvedAsByTheSolver) {
  Plate oblong = acrylic_plate();
  oblong.b = {310.0};
  for (const auto& support : {corners(0.0), corners(7.3), edges()}) {
    const std::vector<Point> probes{at(86.0, 62.0), at(301.0, 124.0)};  // on nodes, where a row is read without interpolation
    const auto rows = table(oblong, support, probes);
    for (const Patch& patch : {Patch{at(129.0, 217.0), {0.0}, {0.0}}, Patch{at(215.0, 155.0), {430.0}, {310.0}}}) {
      const auto solution = solve({oblong, support, {{patch, {1.0}}}, probes}, PlateMethod::Fdm, {.divisions = 40});
      ASSERT_TRUE(solution);
      for (std::size_t k = 0; k < probes.size(); ++k) {
        expect_within(rows.under_patch_mm_per_n(k, patch), solution->probes[k].deflection_mm, 1e-6, "probe");
      }
    }
  }
}

TEST(InfluenceTable, LoadAndProbe_CanBeSwapped) {
  for (const auto& support : {corners(0.0), corners(7.3), edges()}) {
    const Point here = at(86.0, 97.3);
    const Point there = at(301.7, 250.2);
    const auto rows = table(steel_plate(), support, {here, there});

    const double reciprocal = rows.at_point_mm_per_n(1, here);

    EXPECT_NEAR(rows.at_point_mm_per_n(0, there), reciprocal, 1e-7 * reciprocal);
  }
}

TEST(InfluenceTable, InsetBetweenNodes_IsAsGoodAsOneOnANode) {
  for (const double inset_mm : {2.5, 5.375, 13.0}) {
    const std::vector<Point> probes{kCentre};
    const double mesh = table(steel_plate(), corners(inset_mm), probes).at_point_mm_per_n(0, kCentre);
    const double plate = RefinedPlate(steel_plate(), corners(inset_mm), probes).under_point(0, kCentre);

    expect_within(mesh, plate, 0.4, "0.2 % of the mesh (plate-model 4 E) and 0.13 % of the support (section 2)");
  }
}

TEST(InfluenceTable, SupportPoints_DoNotMove) {
  const double inset_mm = 7.3;
  const auto rows = table(steel_plate(), corners(inset_mm), {at(inset_mm, inset_mm), at(430.0 - inset_mm, inset_mm), kCentre});
  const double centre = rows.at_point_mm_per_n(2, kCentre);

  EXPECT_NEAR(rows.at_point_mm_per_n(0, kCentre), 0.0, 1e-6 * centre);
  EXPECT_NEAR(rows.at_point_mm_per_n(1, at(300, 20)), 0.0, 1e-6 * centre);
}

TEST(InfluenceTable, LoadOffThePlate_CountsAsItsNearestEdge) {
  const auto rows = table(steel_plate(), corners(20.0), {at(100, 100)});

  EXPECT_DOUBLE_EQ(rows.at_point_mm_per_n(0, at(-50, 200)), rows.at_point_mm_per_n(0, at(0, 200)));
  EXPECT_DOUBLE_EQ(rows.at_point_mm_per_n(0, at(1e300, 1e300)), rows.at_point_mm_per_n(0, at(430, 430)));
}

TEST(InfluenceTable, NotANumberOrNoSuchProbe_GivesNan) {
  const auto rows = table(steel_plate(), corners(0.0), {kCentre});

  EXPECT_TRUE(std::isnan(rows.at_point_mm_per_n(0, at(std::nan(""), 10))));
  EXPECT_TRUE(std::isnan(rows.at_point_mm_per_n(0, at(10, -INFINITY))));
  EXPECT_TRUE(std::isnan(rows.at_point_mm_per_n(1, kCentre)));
  EXPECT_TRUE(std::isnan(rows.under_patch_mm_per_n(0, {kCentre, {std::nan("")}, {10.0}})));
  EXPECT_TRUE(std::isnan(rows.under_patch_mm_per_n(0, {kCentre, {10.0}, {INFINITY}})));
}

/// The mean of many point loads spread over the patch.
double by_points(const InfluenceTable& rows, const Patch& patch, int count) {
  double sum = 0.0;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      const double x = patch.centre.x.value + patch.width.value * ((i + 0.5) / count - 0.5);
      const double y = patch.centre.y.value + patch.height.value * ((j + 0.5) / count - 0.5);
      sum += rows.at_point_mm_per_n(0, at(x, y));
    }
  }
  return sum / (count * count);
}

TEST(InfluenceTablePatch, AnyPatch_IsTheMeanOfPointLoads) {
  const auto rows = table(steel_plate(), corners(10.75), {at(86, 86)});

  for (const Patch& patch : {Patch{at(150, 130), {90.0}, {250.0}}, Patch{at(101.3, 77.7), {3.0}, {4.0}}, Patch{kCentre, {430.0}, {430.0}},
                             Patch{at(20, 410), {40.0}, {40.0}}}) {
    const double reference = by_points(rows, patch, 400);
    EXPECT_NEAR(rows.under_patch_mm_per_n(0, patch), reference, 1e-5 * std::abs(reference));
  }
}

TEST(InfluenceTablePatch, NoSize_IsAPointLoad) {
  const auto rows = table(steel_plate(), corners(10.75), {at(86, 86)});
  const double point = rows.at_point_mm_per_n(0, at(123.4, 56.7));

  EXPECT_DOUBLE_EQ(rows.under_patch_mm_per_n(0, {at(123.4, 56.7), {0.0}, {0.0}}), point);
  EXPECT_DOUBLE_EQ(rows.under_patch_mm_per_n(0, {at(123.4, 56.7), {-5.0}, {-5.0}}), point);
  EXPECT_NEAR(rows.under_patch_mm_per_n(0, {at(123.4, 56.7), {1e-5}, {1e-5}}), point, 1e-9);
}

TEST(InfluenceTablePatch, OverhangingPatch_PutsItsWholeLoadOnThePlate) {
  const auto rows = table(steel_plate(), corners(10.75), {at(86, 86)});

  const double overhanging = rows.under_patch_mm_per_n(0, {at(0, 200), {100.0}, {60.0}});
  const double outside = rows.under_patch_mm_per_n(0, {at(-500, 200), {100.0}, {60.0}});

  EXPECT_NEAR(overhanging, rows.under_patch_mm_per_n(0, {at(25, 200), {50.0}, {60.0}}), 1e-12);
  EXPECT_NEAR(outside, rows.under_patch_mm_per_n(0, {at(0, 200), {0.0}, {60.0}}), 1e-12);
}

}  // namespace
}  // namespace dts::physics
