// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/solve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::acrylic_plate;
using test::at;
using test::corners;
using test::edges;
using test::kGravity;
using test::steel_plate;

constexpr Support kXEdges{.kind = SupportKind::XEdges};
constexpr Support kClamped{.kind = SupportKind::Clamped};

PlateLoad point_load(double x_mm, double y_mm, double force_n) { return {.area = {.centre = at(x_mm, y_mm)}, .force = {force_n}}; }
PlateLoad pressure(const Plate& plate, double force_n) {
  return {.area = {.centre = {plate.a / 2, plate.b / 2}, .width = plate.a, .height = plate.b}, .force = {force_n}};
}

/// A square of 1 m, D = 1 N m.
Plate unit_plate(double nu) { return {.a = {1000.0}, .b = {1000.0}, .h = {10.0}, .e_pa = 12.0 * (1.0 - nu * nu) / 1e-6, .nu = nu}; }

double deflection_mm(const PlateCase& plate_case, PlateMethod method, SolveOptions options) {
  const auto solution = solve(plate_case, method, options);
  EXPECT_TRUE(solution) << core::to_string(solution.error());
  return solution ? solution->probes.front().deflection_mm : 0.0;
}

class BothMethods : public testing::TestWithParam<PlateMethod> {};
INSTANTIATE_TEST_SUITE_P(Plate, BothMethods, testing::Values(PlateMethod::Fdm, PlateMethod::Fem),
                         [](const auto& tested) { return tested.param == PlateMethod::Fdm ? "Fdm" : "Fem"; });

// Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells: tables 8 (supported), 35 (clamped, corrected digits after Taylor and
// Govindjee 2004); corner supports after plate-model section 4 G. Units: P a^2 / D and q a^4 / D, both 1 for the unit plate and 1 N.
struct Anchor {
  const char* name;
  Support support;
  double nu;
  bool is_pressure;
  double deflection_m;
};
const Anchor kAnchors[] = {
    {"supported, central load", edges(), 0.3, false, 0.0116008},       {"supported, pressure", edges(), 0.3, true, 0.00406235},
    {"clamped, central load", kClamped, 0.3, false, 0.00561202},       {"clamped, pressure", kClamped, 0.3, true, 0.00126532},
    {"corners, central load, 0.3", corners(0.0), 0.3, false, 0.03914}, {"corners, central load, 0.25", corners(0.0), 0.25, false, 0.03960},
    {"corners, pressure, 0.3", corners(0.0), 0.3, true, 0.025506},     {"corners, pressure, 0.25", corners(0.0), 0.25, true, 0.025669},
};

TEST_P(BothMethods, AnalyticAnchors_AreMetWithinATenthOfAPercent) {
  RecordProperty("requirement", "LAB-2");
  for (const Anchor& anchor : kAnchors) {
    const Plate plate = unit_plate(anchor.nu);
    const PlateCase plate_case{
        plate, anchor.support, {anchor.is_pressure ? pressure(plate, 1.0) : point_load(500, 500, 1.0)}, {at(500, 500)}};
    const auto solution = solve(plate_case, GetParam(), {.divisions = GetParam() == PlateMethod::Fdm ? 80 : 24});
    ASSERT_TRUE(solution) << anchor.name;
    const auto& [found_mm, error_mm] = solution->probes.front();
    const double expected_mm = 1e3 * anchor.deflection_m;
    // The finite differences extrapolated: what they are worth and their estimate of their error at once.
    EXPECT_NEAR((GetParam() == PlateMethod::Fdm ? found_mm - error_mm : found_mm) / expected_mm, 1.0, 1e-3) << anchor.name;
  }
}

TEST_P(BothMethods, XEdgesUnderPressure_MeetLevy) {
  // Timoshenko and Woinowsky-Krieger, table 47 (two opposite edges supported, two free, square, nu 0.3): centre 0.01309 q a^4 / D.
  const Plate plate = unit_plate(0.3);
  const PlateCase plate_case{plate, kXEdges, {pressure(plate, 1.0)}, {at(500, 500)}};
  EXPECT_NEAR(deflection_mm(plate_case, GetParam(), {.divisions = default_divisions(GetParam(), false)}), 13.09, 0.02);
}

TEST_P(BothMethods, Reactions_CarryTheLoads) {
  const Plate plate{.a = {500.0}, .b = {300.0}, .h = {4.0}, .e_pa = 70e9, .nu = 0.33};
  for (const Support& support : {corners(13.0), edges(), kXEdges, kClamped}) {
    for (const bool is_nonlinear : {false, true}) {
      const PlateCase plate_case{plate, support, {point_load(130, 70, 200), pressure(plate, 100)}, {}};
      const auto solution = solve(plate_case, GetParam(), {.divisions = 16, .is_nonlinear = is_nonlinear});
      ASSERT_TRUE(solution) << core::to_string(solution.error());
      const auto& reactions_n = solution->reactions_n;
      EXPECT_EQ(reactions_n.size(), support.kind == SupportKind::XEdges ? 2U : 4U);
      EXPECT_NEAR(std::accumulate(reactions_n.begin(), reactions_n.end(), 0.0), 300.0, 1e-5);
    }
  }
}

TEST_P(BothMethods, CornerReactions_HaveTheMomentOfTheLoad) {
  const PlateCase plate_case{steel_plate(), corners(10.75), {point_load(130, 300, 200)}, {}};
  const auto solution = solve(plate_case, GetParam(), {});
  ASSERT_TRUE(solution);
  const auto& r = solution->reactions_n;  // (-,-), (+,-), (-,+), (+,+)
  EXPECT_NEAR((r[0] + r[2]) * 10.75 + (r[1] + r[3]) * 419.25, 200.0 * 130.0, 0.01);
  EXPECT_NEAR((r[0] + r[1]) * 10.75 + (r[2] + r[3]) * 419.25, 200.0 * 300.0, 0.01);
}

TEST_P(BothMethods, HeldEdges_DoNotMove) {
  for (const Support& support : {edges(), kClamped, kXEdges}) {
    const PlateCase plate_case{steel_plate(), support, {point_load(100, 60, 50)}, {at(0, 123), at(430, 300), at(0, 0)}};
    const auto solution = solve(plate_case, GetParam(), {});
    ASSERT_TRUE(solution);
    for (const auto& probe : solution->probes) EXPECT_NEAR(probe.deflection_mm, 0.0, 1e-12);
    if (support.kind == SupportKind::Clamped) {  // no slope either: a quarter of the distance, a sixteenth of the deflection
      EXPECT_NEAR(solution->deflection_mm(at(10, 215)) / solution->deflection_mm(at(40, 215)), 1.0 / 16.0, 0.025);
    }
  }
}

TEST(PlateSolve, FdmErrorEstimate_IsTheThesisFigureAndAbsentOnTheCoarsestGrid) {
  // Thesis 3.5: 0.33 % for the edge-supported plate; plate-model section 4 E: 0.332 %.
  const PlateCase plate_case{acrylic_plate(), edges(), {point_load(215, 215, kGravity)}, {at(215, 215)}};
  const auto solution = solve(plate_case, PlateMethod::Fdm, {.divisions = 40});
  ASSERT_TRUE(solution);
  const auto& [deflection_mm, error_mm] = solution->probes.front();
  EXPECT_NEAR(100.0 * error_mm / deflection_mm, 0.332, 0.01);
  EXPECT_TRUE(std::isnan(solve(plate_case, PlateMethod::Fdm, {.divisions = 4})->probes.front().error_estimate_mm));
}

TEST(PlateSolve, NonlinearSolution_ReportsItsProgress) {
  std::vector<double> reported;
  const PlateCase plate_case{steel_plate(), corners(10.75), {point_load(180, 150, 500)}, {at(86, 86)}};
  ASSERT_TRUE(solve(plate_case, PlateMethod::Fdm,
                    {.divisions = 8, .is_nonlinear = true, .report_progress = [&](double part) { reported.push_back(part); }}));
  ASSERT_GE(reported.size(), 3U);
  EXPECT_LT(reported.front(), 0.5);
  EXPECT_TRUE(std::ranges::is_sorted(reported));
  EXPECT_EQ(reported.back(), 1.0);
}

TEST(PlateSolve, SimpsonLoad_LowersTheErrorUnderTheLoad) {
  // Thesis eq. 3.13; research figures: +0.436 % nodal, -0.21 % Simpson at 40 divisions.
  const PlateCase plate_case{unit_plate(0.3), edges(), {point_load(500, 500, 1.0)}, {at(500, 500)}};
  EXPECT_NEAR(100.0 * (deflection_mm(plate_case, PlateMethod::Fdm, {.divisions = 40}) / 11.6008 - 1.0), 0.436, 0.02);
  EXPECT_NEAR(100.0 * (deflection_mm(plate_case, PlateMethod::Fdm, {.divisions = 40, .spreads_point_loads = true}) / 11.6008 - 1.0), -0.21,
              0.02);
}

TEST_P(BothMethods, SmallLoad_StiffensNothing) {
  const PlateCase plate_case{steel_plate(), corners(10.75), {point_load(180, 150, 0.5)}, {at(86, 86), at(215, 215)}};
  const auto linear = solve(plate_case, GetParam(), {.divisions = 16});
  const auto nonlinear = solve(plate_case, GetParam(), {.divisions = 16, .is_nonlinear = true});
  ASSERT_TRUE(linear && nonlinear);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(nonlinear->probes[k].deflection_mm / linear->probes[k].deflection_mm, 1.0, 1e-5);
}

TEST_P(BothMethods, ReversedLoad_BendsTheOtherWay) {
  PlateCase plate_case{steel_plate(), corners(10.75), {point_load(180, 150, 500)}, {at(86, 86)}};
  const double down = deflection_mm(plate_case, GetParam(), {.divisions = 16, .is_nonlinear = true});
  plate_case.loads = {point_load(180, 150, -500)};
  EXPECT_NEAR(deflection_mm(plate_case, GetParam(), {.divisions = 16, .is_nonlinear = true}), -down, 1e-6 * down);
}

TEST_P(BothMethods, LoadThatBendsNothing_IsSolvedToo) {
  for (const bool is_nonlinear : {false, true}) {
    const auto solution = solve({steel_plate(), edges(), {point_load(0, 215, 49)}, {at(215, 215)}}, GetParam(),
                                {.divisions = 8, .is_nonlinear = is_nonlinear});
    ASSERT_TRUE(solution) << core::to_string(solution.error());
    EXPECT_EQ(solution->probes.front().deflection_mm, 0.0);
    EXPECT_NEAR(solution->reactions_n.front(), 49.0, 1e-9);
  }
}

core::Error refused(const PlateCase& plate_case, PlateMethod method = PlateMethod::Fdm, const SolveOptions& options = {}) {
  const auto solution = solve(plate_case, method, options);
  EXPECT_FALSE(solution);
  return solution ? core::Error{} : solution.error();
}

TEST(PlateSolveInput, BadInput_IsRefusedWithItsRange) {
  const PlateCase good{steel_plate(), corners(0.0), {point_load(100, 100, 10)}, {at(1, 1)}};
  const auto with = [&](auto change) {
    PlateCase changed = good;
    change(changed);
    return refused(changed).what;
  };
  using testing::HasSubstr;
  EXPECT_THAT(with([](PlateCase& c) { c.plate.h = {-1.0}; }), HasSubstr("thickness"));
  EXPECT_THAT(with([](PlateCase& c) { c.plate.nu = 0.5; }), HasSubstr("-1..0.5"));
  EXPECT_THAT(with([](PlateCase& c) { c.loads.clear(); }), HasSubstr("no load"));
  EXPECT_THAT(with([](PlateCase& c) { c.loads = {point_load(431, 10, 5)}; }), HasSubstr("load 1: x is 431, outside the plate, 0..430 mm"));
  EXPECT_THAT(with([](PlateCase& c) { c.loads.push_back({.area = {.centre = at(10, 10), .width = {40.0}}, .force = {5.0}}); }),
              HasSubstr("load 2"));
  EXPECT_THAT(with([](PlateCase& c) { c.loads = {point_load(10, 10, 0)}; }), HasSubstr("other than 0"));
  EXPECT_THAT(with([](PlateCase& c) { c.loads = {point_load(10, 10, std::numeric_limits<double>::quiet_NaN())}; }), HasSubstr("load 1"));
  EXPECT_THAT(with([](PlateCase& c) { c.probes = {at(0, -0.1)}; }), HasSubstr("probe 1: y"));
  EXPECT_THAT(with([](PlateCase& c) { c.support = corners(214.9999); }), HasSubstr("tips"));
  EXPECT_THAT(refused(good, PlateMethod::Fdm, {.divisions = 1}).what, HasSubstr("4..200"));
  EXPECT_THAT(refused(good, PlateMethod::Fem, {.divisions = 5000}).what, HasSubstr("4..200"));
  EXPECT_THAT(refused(good, PlateMethod::Fem, {.divisions = 100, .is_nonlinear = true}).what, HasSubstr("4..80"));
  EXPECT_THAT(refused(good, PlateMethod::Fem, {.spreads_point_loads = true}).what, HasSubstr("Simpson"));
}

}  // namespace
}  // namespace dts::physics
