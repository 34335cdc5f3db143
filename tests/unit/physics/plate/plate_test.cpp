// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/influence_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

std::vector<double> deflections_mm(const Plate& plate, const Support& support, double s_mm, double load_n) {
  const auto rows = table(plate, support, verification_positions(s_mm));
  std::vector<double> result;
  for (std::size_t k = 0; k < rows.probe_count(); ++k) result.push_back(load_n * rows.at_point_mm_per_n(k, kCentre));
  return result;
}

TEST(Plate, Materials_HaveTheRigidityOfTheSheet) {
  EXPECT_NEAR(steel_plate().rigidity_nm(), 482.23, 0.005);
  EXPECT_NEAR(acrylic_plate().rigidity_nm(), 20.65, 0.005);
}

TEST(InfluenceTable, Acrylic1Kgf_MatchesTheFiniteElementColumnOfTable32) {
  const auto at_86 = deflections_mm(acrylic_plate(), corners(0.0), 86.0, kGravity);
  const auto best_fit = deflections_mm(acrylic_plate(), corners(0.0), 85.3, kGravity);

  expect_within(at_86[0], 2.030, 1.0, "sensor 1");
  expect_within(at_86[1], 2.709, 0.5, "sensor 2");
  expect_within(at_86[2], 3.430, 0.3, "sensor 3");
  expect_within(best_fit[0], 2.030, 0.2, "sensor 1, best fit");
  expect_within(best_fit[1], 2.709, 0.2, "sensor 2, best fit");
}

TEST(InfluenceTable, Steel20Kgf_MatchesTheFiniteElementColumnOfTable33) {
  const auto at_86 = deflections_mm(steel_plate(), corners(10.75), 86.0, 20.0 * kGravity);

  expect_within(at_86[0], 1.3675, 2.5, "sensor 1");
  expect_within(at_86[1], 1.886, 1.0, "sensor 2");
  expect_within(at_86[2], 2.466, 0.8, "sensor 3");
}

TEST(InfluenceTable, Steel20KgfBestFit_MatchesTheFiniteElementColumnOfTable33) {
  // The sheet's best fit is that of the plate, not of its 40 x 40 mesh.
  const RefinedPlate plate(steel_plate(), corners(10.9), verification_positions(88.4));

  expect_within(20.0 * kGravity * plate.under_point(0, kCentre), 1.3675, 0.3, "sensor 1");
  expect_within(20.0 * kGravity * plate.under_point(1, kCentre), 1.886, 0.3, "sensor 2");
  expect_within(20.0 * kGravity * plate.under_point(2, kCentre), 2.466, 0.3, "sensor 3");
}

TEST(InfluenceTable, FiniteDifferenceColumns_AreMissedByNoMoreThanTheirKnownError) {
  // Plate-model 4 B: those columns cannot be reproduced; the band keeps the model from drifting away from them.
  const auto acrylic = deflections_mm(acrylic_plate(), corners(0.0), 86.0, kGravity);
  const auto steel = deflections_mm(steel_plate(), corners(10.75), 86.0, 20.0 * kGravity);

  expect_within(acrylic[0], 2.002, 3.0, "acrylic 1");
  expect_within(acrylic[1], 2.821, 6.0, "acrylic 2");
  expect_within(acrylic[2], 3.649, 7.0, "acrylic 3");
  expect_within(steel[0], 1.36, 3.0, "steel 1");
  expect_within(steel[1], 1.983, 6.0, "steel 2");
  expect_within(steel[2], 2.65, 7.0, "steel 3");
}

TEST(InfluenceTable, SensorRatios_MatchTables34And35) {
  const auto acrylic = deflections_mm(acrylic_plate(), corners(0.0), 86.0, kGravity);
  const auto steel = deflections_mm(steel_plate(), corners(10.75), 86.0, kGravity);

  expect_within(acrylic[0] / acrylic[1], 0.7496, 1.0, "acrylic S1/S2");
  expect_within(acrylic[0] / acrylic[2], 0.5918, 1.0, "acrylic S1/S3");
  expect_within(steel[0] / steel[1], 0.7251, 3.0, "steel S1/S2");
  expect_within(steel[0] / steel[2], 0.5547, 3.0, "steel S1/S3");
}

TEST(InfluenceTable, AcrylicCentre_MatchesThesis351) {
  const std::vector<Point> probes{kCentre};

  const auto on_edges = table(acrylic_plate(), edges(), probes);
  const auto on_corners = table(acrylic_plate(), corners(0.0), probes);

  expect_within(10.0 * on_edges.at_point_mm_per_n(0, kCentre), 1.0386, 0.5, "edge supported, 10 N");
  expect_within(kGravity * on_corners.at_point_mm_per_n(0, kCentre), 3.430, 0.5, "corner supported, 1 kgf");
}

TEST(InfluenceTable, EdgeSupported_ConvergesAsTheThesisSays) {
  const std::vector<Point> probes{kCentre};
  const double w20 = table(acrylic_plate(), edges(), probes, 20).at_point_mm_per_n(0, kCentre);
  const double w40 = table(acrylic_plate(), edges(), probes, 40).at_point_mm_per_n(0, kCentre);

  // Thesis 3.2: 0.33 % at the centre.
  EXPECT_NEAR(100.0 * std::abs(w40 - w20) / 3.0 / w40, 0.332, 0.01);
}

TEST(InfluenceTable, SimplySupportedSquare_MeetsNavier) {
  const Plate plate = steel_plate();
  const RefinedPlate refined(plate, edges(), std::vector<Point>{kCentre});
  const double unit = 0.43 * 0.43 / plate.rigidity_nm() * 1000.0;

  expect_within(refined.under_point(0, kCentre), 0.011600 * unit, 0.1, "central load");
  expect_within(refined.under_patch(0, {kCentre, {430.0}, {430.0}}), 0.00406235 * unit, 0.1, "uniform load");
}

TEST(InfluenceTable, CornerSupportedSquare_MeetsTheSeriesSolutions) {
  struct Anchor {
    double nu, central_load, uniform_load;
  };
  for (const auto& [nu, central_load, uniform_load] : {Anchor{0.3, 0.03914, 0.025506}, Anchor{0.25, 0.03960, 0.025669}}) {
    Plate plate = steel_plate();
    plate.nu = nu;
    const double unit = 0.43 * 0.43 / plate.rigidity_nm() * 1000.0;

    const RefinedPlate refined(plate, corners(0.0), std::vector<Point>{kCentre});

    expect_within(refined.under_point(0, kCentre), central_load * unit, 0.1, "central load");
    expect_within(refined.under_patch(0, {kCentre, {430.0}, {430.0}}), uniform_load * unit, 0.1, "uniform load");
  }
}

TEST(InfluenceTable, SmallestMesh_ErrsAsASecondOrderSchemeMust) {
  const std::vector<Point> probes{kCentre};
  const double coarse = table(steel_plate(), corners(0.0), probes, Grid::kMinDivisions).at_point_mm_per_n(0, kCentre);

  // 0.194 % at 40 divisions (plate-model 4 E) grows with the square of the mesh size.
  expect_within(coarse, table(steel_plate(), corners(0.0), probes).at_point_mm_per_n(0, kCentre), 19.4, "4 divisions");
}

TEST(InfluenceTable, OblongPlate_TurnsWithItsAxes) {
  Plate lying = acrylic_plate();
  lying.a = {400.0};
  lying.b = {360.0};
  Plate standing = lying;
  std::swap(standing.a, standing.b);

  const auto across = table(lying, corners(7.0), {at(120, 90)});
  const auto along = table(standing, corners(7.0), {at(90, 120)});

  EXPECT_NEAR(across.at_point_mm_per_n(0, at(301, 47)), along.at_point_mm_per_n(0, at(47, 301)), 1e-9);
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

TEST(InfluenceTable, MirroredLoad_BendsTheMirroredProbe) {
  const auto rows = table(steel_plate(), corners(10.75), test::floor_sensors());

  for (const Point& load : {at(100.0, 180.0), at(20.0, 401.0), at(215.0, 300.0)}) {
    const Point mirrored = at(430.0 - load.x.value, load.y.value);
    EXPECT_NEAR(rows.at_point_mm_per_n(0, load), rows.at_point_mm_per_n(1, mirrored), 1e-9);
    EXPECT_NEAR(rows.at_point_mm_per_n(2, load), rows.at_point_mm_per_n(3, mirrored), 1e-9);
  }
  for (std::size_t k = 1; k < rows.probe_count(); ++k) {
    EXPECT_NEAR(rows.at_point_mm_per_n(k, kCentre), rows.at_point_mm_per_n(0, kCentre), 1e-9);
  }
}

TEST(InfluenceTable, CentralDeflection_FallsSmoothlyWithTheInset) {
  // One cell is 10.75 mm: insets between nodes must neither jump nor round.
  std::vector<double> central;
  for (int step = 0; step <= 8; ++step) {
    central.push_back(table(steel_plate(), corners(2.6875 * step), {kCentre}).at_point_mm_per_n(0, kCentre));
  }

  for (std::size_t k = 1; k < central.size(); ++k) {
    const double fall = central[k - 1] / central[k] - 1.0;
    EXPECT_GT(fall, 0.02) << k;
    EXPECT_LT(fall, 0.08) << k;
  }
}

TEST(InfluenceTable, InsetBetweenNodes_IsAsGoodAsOneOnANode) {
  for (const double inset_mm : {2.5, 5.375, 8.0, 13.0}) {
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

TEST(InfluenceTablePatch, Halves_AverageToTheWhole) {
  const auto rows = table(steel_plate(), corners(10.75), {at(86, 86)});
  const double whole = rows.under_patch_mm_per_n(0, {at(200, 150), {90.0}, {250.0}});

  const double left = rows.under_patch_mm_per_n(0, {at(177.5, 150), {45.0}, {250.0}});
  const double right = rows.under_patch_mm_per_n(0, {at(222.5, 150), {45.0}, {250.0}});

  EXPECT_NEAR(0.5 * (left + right), whole, 1e-12);
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
