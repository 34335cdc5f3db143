// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "physics/plate/solve.h"
#include "unit/physics/floor_platform.h"

// Plates that nobody tuned anything for, at the default divisions: within 0.5 % of converged references, 0.2 % away from point loads.

namespace dts::physics {
namespace {

using test::at;

constexpr int kPlatesPerSupport = 2;
/// The element converges with the fourth order: half as many divisions more than its default stand for the plate itself. Its own
/// anchors are in solve_test.cpp.
constexpr int kReferenceDivisions = 60;

struct Unseen {
  PlateCase plate_case;  ///< The last probe is where the load is.
  bool is_point_load = false;
};

Unseen draw(SupportKind kind, std::mt19937& random) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  Unseen unseen{
      .plate_case =
          {{.a = {uniform(250, 700)}, .b = {uniform(250, 700)}, .h = {uniform(1, 8)}, .e_pa = uniform(1e9, 2e11), .nu = uniform(0.1, 0.4)},
           {.kind = kind, .inset = {uniform(0, 40)}},
           {},
           {}},
      .is_point_load = uniform(0, 1) < 0.5};
  const Plate& plate = unseen.plate_case.plate;
  const auto inside = [&](double low, double high) { return at(uniform(low, high) * plate.a.value, uniform(low, high) * plate.b.value); };
  const double side = unseen.is_point_load ? 0.0 : uniform(30, 90);
  const Point load = inside(0.25, 0.75);
  unseen.plate_case.loads = {{.area = {.centre = load, .width = {side}, .height = {side}}, .force = {10.0}}};
  for (int k = 0; k < 5; ++k) unseen.plate_case.probes.push_back(inside(0.15, 0.85));
  unseen.plate_case.probes.push_back(load);
  return unseen;
}

/// Deviation of every probe from the reference, %. Probes that hardly move are left out: there a per cent means nothing.
std::vector<double> deviations_percent(const PlateCase& plate_case, PlateMethod method, const PlateSolution& reference) {
  const auto solution = solve(plate_case, method, {.divisions = default_divisions(method, false)});
  EXPECT_TRUE(solution);
  const double largest_mm = std::abs(reference.probes.back().deflection_mm);
  std::vector<double> deviations;
  for (std::size_t k = 0; k < plate_case.probes.size(); ++k) {
    const double expected_mm = reference.probes[k].deflection_mm;
    const bool moves = std::abs(expected_mm) > 0.03 * largest_mm;
    deviations.push_back(moves ? 100.0 * (solution->probes[k].deflection_mm / expected_mm - 1.0) : 0.0);
  }
  return deviations;
}

class UnseenPlates : public testing::TestWithParam<SupportKind> {};
std::string name_of(const testing::TestParamInfo<SupportKind>& tested) {
  return std::array<std::string, 4>{"Corner", "Edges", "XEdges", "Clamped"}[static_cast<std::size_t>(tested.param)];
}
INSTANTIATE_TEST_SUITE_P(Supports, UnseenPlates,
                         testing::Values(SupportKind::Corner, SupportKind::Edges, SupportKind::XEdges, SupportKind::Clamped), name_of);

TEST_P(UnseenPlates, BothMethods_MeetTheReference) {
  RecordProperty("requirement", "LAB-2");
  std::mt19937 random(20250131);
  for (int plate = 0; plate < kPlatesPerSupport; ++plate) {
    const auto [plate_case, is_point_load] = draw(GetParam(), random);
    const auto reference = solve(plate_case, PlateMethod::Fem, {.divisions = kReferenceDivisions});
    ASSERT_TRUE(reference);
    for (const auto method : {PlateMethod::Fdm, PlateMethod::Fem}) {
      const auto deviations = deviations_percent(plate_case, method, *reference);
      for (std::size_t k = 0; k < deviations.size(); ++k) {
        const bool is_under_point_load = is_point_load && k + 1 == deviations.size();
        EXPECT_LE(std::abs(deviations[k]), is_under_point_load ? 0.5 : 0.2)
            << (method == PlateMethod::Fdm ? "fdm" : "fem") << ", plate " << plate << ", probe " << k;
      }
    }
  }
}

// Shells that bend and stretch, solved by CalculiX 2.20 (40 x 40 S8R elements, NLGEOM): the steel platform, supports inset 10.75 mm and
// free to slide, a load at the centre and one at (150.5, 182.75). Deflections of w1..w4 and the centre, mm.
struct ShellSolution {
  Point load;
  double force_n;
  std::array<double, 5> deflection_mm;
};
const ShellSolution kShell[] = {
    {at(215, 215), 720, {4.1615, 4.1615, 4.1615, 4.1615, 7.2907}},
    {at(150.5, 182.75), 480, {3.5057, 2.5977, 3.0037, 2.3013, 4.8467}},
};

TEST(NonlinearPlate, SteelPlatform_MeetsTheShellSolution) {
  RecordProperty("requirement", "LAB-3");
  for (const auto method : {PlateMethod::Fdm, PlateMethod::Fem}) {
    for (const auto& [load, force_n, expected_mm] : kShell) {
      auto probes = test::floor_sensors();
      probes.push_back(at(215, 215));
      const PlateCase plate_case{test::steel_plate(), test::corners(10.75), {{.area = {.centre = load}, .force = {force_n}}}, probes};
      const auto solution = solve(plate_case, method, {.divisions = default_divisions(method, true), .is_nonlinear = true});
      ASSERT_TRUE(solution) << core::to_string(solution.error());
      for (std::size_t k = 0; k < probes.size(); ++k) {
        EXPECT_NEAR(solution->probes[k].deflection_mm / expected_mm[k], 1.0, 0.005) << force_n << " N, probe " << k;
      }
    }
  }
}

}  // namespace
}  // namespace dts::physics
