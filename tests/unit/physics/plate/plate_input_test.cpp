// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/special_numbers.h"
#include "physics/plate/influence_table.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using core::kInfinity;
using core::kNaN;
using test::at;
using testing::AllOf;
using testing::HasSubstr;

/// Everything `InfluenceTable::create` is given; good until a test spoils it.
struct Input {
  Plate plate = test::steel_plate();
  Support support = test::corners(10.75);
  std::vector<Point> probes{at(86, 86)};
  int divisions = 8;
};

core::Result<InfluenceTable> create(const std::function<void(Input&)>& spoil) {
  Input input;
  spoil(input);
  return InfluenceTable::create(input.plate, input.support, input.probes, input.divisions);
}

void expect_refused(const std::function<void(Input&)>& spoil, const char* value, const char* range) {
  const auto result = create(spoil);

  ASSERT_FALSE(result) << value;
  EXPECT_EQ(result.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(result.error().what, AllOf(HasSubstr(value), HasSubstr(range)));
}

TEST(InfluenceTableInput, GoodInput_IsTaken) {
  EXPECT_TRUE(create([](Input&) {}));
  EXPECT_TRUE(create([](Input& input) { input.divisions = Grid::kMinDivisions; }));
  EXPECT_TRUE(create([](Input& input) { input.probes = {at(0, 0), at(430, 430)}; }));
  EXPECT_TRUE(create([](Input& input) { input.plate.nu = -0.999; }));
  EXPECT_TRUE(create([](Input& input) { input.plate.nu = 0.499; }));
}

TEST(InfluenceTableInput, BadSides_AreRefusedWithTheRange) {
  for (const double bad : {kNaN, kInfinity, -430.0, 0.0, 0.43, 430'000.0}) {
    expect_refused([&](Input& input) { input.plate.a = {bad}; }, "plate length a", "10..10000 mm");
    expect_refused([&](Input& input) { input.plate.b = {bad}; }, "plate length b", "10..10000 mm");
  }
  expect_refused([](Input& input) { input.plate.a = {9000.0}; }, "ratio of the plate's sides is 20.9302", "1..20");
}

TEST(InfluenceTableInput, BadThickness_IsRefusedWithTheRange) {
  for (const double bad : {kNaN, kInfinity, -3.0, 0.0, 0.003, 87.0}) {
    expect_refused([&](Input& input) { input.plate.h = {bad}; }, "plate thickness h", "0.01..86 mm");
  }
}

TEST(InfluenceTableInput, BadMaterial_IsRefusedWithTheRange) {
  for (const double bad : {kNaN, kInfinity, -1.0, 0.0, 198.7}) {
    expect_refused([&](Input& input) { input.plate.e_pa = bad; }, "Young's modulus", "100000..1e+13 Pa");
  }
  for (const double bad : {kNaN, kInfinity, -1.0, 0.5, 0.7}) {
    expect_refused([&](Input& input) { input.plate.nu = bad; }, "Poisson's ratio", "-1..0.5");
  }
}

TEST(InfluenceTableInput, BadSupport_IsRefusedWithTheRange) {
  for (const double bad : {kNaN, kInfinity, -0.1, 215.0, 500.0}) {
    expect_refused([&](Input& input) { input.support.inset = {bad}; }, "support inset", "0..215 mm");
  }
  expect_refused([](Input& input) { input.support.kind = static_cast<SupportKind>(7); }, "support kind is 7", "0 (corner) to 3 (clamped)");
}

TEST(InfluenceTableInput, SupportsInOnePoint_DoNotHoldThePlate) {
  expect_refused([](Input& input) { input.support.inset = {214.9999999}; }, "support inset", "tips");
}

TEST(InfluenceTableInput, InsetOfEdgeSupports_DoesNotMatter) {
  EXPECT_TRUE(create([](Input& input) { input.support = {SupportKind::Edges, {kNaN}}; }));
}

TEST(InfluenceTableInput, BadProbe_IsRefusedWithItsNumber) {
  for (const double bad : {kNaN, kInfinity, -0.1, 430.1}) {
    expect_refused([&](Input& input) { input.probes.push_back(at(bad, 10)); }, "probe 1: x", "0..430 mm");
    expect_refused([&](Input& input) { input.probes.push_back(at(10, bad)); }, "probe 1: y", "0..430 mm");
  }
  expect_refused([](Input& input) { input.probes.clear(); }, "no probe", "");
}

TEST(InfluenceTableInput, BadDivisions_AreRefusedWithTheRange) {
  for (const int bad : {std::numeric_limits<int>::min(), -1, 0, 3, 201, std::numeric_limits<int>::max()}) {
    expect_refused([&](Input& input) { input.divisions = bad; }, "number of divisions", "4..200");
  }
}

}  // namespace
}  // namespace dts::physics
