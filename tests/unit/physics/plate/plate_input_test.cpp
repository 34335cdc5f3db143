// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "core/special_numbers.h"
#include "physics/plate/influence_table.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using core::kInfinity;
using core::kNaN;
using test::at;

std::string refusal(const core::Status& status) {
  if (status) return {};
  EXPECT_EQ(status.error().code, core::ErrorCode::InvalidArgument);
  return status.error().what;
}

TEST(PlateLimits, ValuesAtThemAreTaken_BeyondThemRefusedWithTheRange) {
  struct Limits {
    std::string name;
    double Plate::*number = nullptr;
    core::Millimetres Plate::*length = nullptr;
    std::vector<double> taken, refused;
    std::string range;
  };
  const Plate square{.a = {500.0}, .b = {500.0}};
  for (const Limits& limits :
       {Limits{"plate length a", nullptr, &Plate::a, {25.0, 10'000.0}, {9.99, 10'001.0, -430.0}, "10..10000 mm"},
        Limits{"plate length b", nullptr, &Plate::b, {25.0, 10'000.0}, {9.99, 10'001.0, -430.0}, "10..10000 mm"},
        Limits{"plate thickness h", nullptr, &Plate::h, {0.01, 100.0}, {0.0099, 100.1, -3.0}, "0.01..100 mm (a fifth of the shorter side)"},
        Limits{"Young's modulus", &Plate::e_pa, nullptr, {1e5, 1e13}, {99'999.0, 1.1e13, -1.0}, "100000..1e+13 Pa"},
        Limits{"Poisson's ratio", &Plate::nu, nullptr, {-0.999, 0.499}, {-1.0, 0.5}, "-1..0.5 (ends excluded)"}}) {
    const auto told = [&](double value) {
      Plate plate = square;
      if (limits.number != nullptr) plate.*limits.number = value;
      if (limits.length != nullptr) plate.*limits.length = {value};
      return refusal(check_plate(plate));
    };
    for (const double good : limits.taken) EXPECT_EQ(told(good), "") << limits.name;
    for (const double bad : limits.refused) {
      std::ostringstream expected;
      expected << limits.name << " is " << bad << ", outside " << limits.range;
      EXPECT_EQ(told(bad), expected.str());
    }
    for (const double bad : {kNaN, kInfinity}) EXPECT_NE(told(bad), "") << limits.name;
  }
  EXPECT_EQ(refusal(check_plate({.a = {10.0}, .b = {200.0}, .h = {2.0}})), "");
  EXPECT_EQ(refusal(check_plate({.a = {10.0}, .b = {201.0}, .h = {2.0}})), "ratio of the plate's sides is 20.1, outside 1..20");
  EXPECT_EQ(refusal(check_plate({.a = {201.0}, .b = {10.0}, .h = {2.0}})), "ratio of the plate's sides is 20.1, outside 1..20");
}

TEST(PlateLimits, SupportsPointsAndDivisions) {
  const Plate plate{.a = {430.0}, .b = {300.0}};
  for (const double inset_mm : {0.0, 149.99}) EXPECT_EQ(refusal(check_support(plate, test::corners(inset_mm))), "");
  EXPECT_EQ(refusal(check_support(plate, test::corners(-0.1))), "support inset is -0.1, outside 0..150 mm (end excluded)");
  EXPECT_EQ(refusal(check_support(plate, test::corners(150.0))), "support inset is 150, outside 0..150 mm (end excluded)");
  for (const double bad : {kNaN, kInfinity}) EXPECT_NE(refusal(check_support(plate, test::corners(bad))), "");
  EXPECT_EQ(refusal(check_support(plate, {SupportKind::Edges, {kNaN}})), "") << "the inset of edges does not matter";
  EXPECT_EQ(refusal(check_support(plate, {static_cast<SupportKind>(4)})), "support kind is 4, outside 0 (corner) to 3 (clamped)");
  EXPECT_EQ(refusal(check_on_plate(plate, at(0, 0), "p")), "");
  EXPECT_EQ(refusal(check_on_plate(plate, at(430, 300), "p")), "");
  for (const double bad : {-0.1, 430.1}) {
    EXPECT_TRUE(refusal(check_on_plate(plate, at(bad, 10), "p")).ends_with(", outside the plate, 0..430 mm"));
    EXPECT_TRUE(refusal(check_on_plate(plate, at(10, bad), "p")).ends_with(", outside the plate, 0..300 mm"));
  }
  EXPECT_EQ(refusal(check_on_plate(plate, at(-1, 400), "p 1")), "p 1: x is -1, outside the plate, 0..430 mm");
  EXPECT_EQ(refusal(check_on_plate(plate, at(1, kNaN), "p 1")), "p 1: y is nan, outside the plate, 0..300 mm");
  for (const int good : {4, 7}) EXPECT_EQ(refusal(check_divisions(good, 4, 7)), "");
  for (const int bad : {3, 8})
    EXPECT_EQ(refusal(check_divisions(bad, 4, 7)), "number of divisions is " + std::to_string(bad) + ", outside 4..7");
}

TEST(InfluenceTableInput, IsCheckedWhole) {
  const auto told = [](const Plate& plate, const Support& support, const std::vector<Point>& probes, int divisions) {
    const auto table = InfluenceTable::create(plate, support, probes, divisions);
    return table ? "" : refusal(tl::make_unexpected(table.error()));
  };
  const Plate good = test::steel_plate();
  Plate thick = good;
  thick.h = {87.0};
  EXPECT_EQ(told(good, test::corners(10.75), {at(0, 0), at(430, 430)}, 4), "");
  EXPECT_TRUE(told(thick, test::corners(10.75), {at(86, 86)}, 8).starts_with("plate thickness h is 87"));
  EXPECT_TRUE(told(good, test::corners(215.0), {at(86, 86)}, 8).starts_with("support inset is 215"));
  EXPECT_NE(told(good, test::corners(214.9999999), {at(86, 86)}, 8).find("tips"), std::string::npos) << "supports in one point";
  EXPECT_TRUE(told(good, test::corners(10.75), {at(86, 86), at(431, 10)}, 8).starts_with("probe 1: x is 431"));
  EXPECT_EQ(told(good, test::corners(10.75), {}, 8), "there is no probe");
  for (const int bad : {3, 201})
    EXPECT_EQ(told(good, test::corners(10.75), {at(86, 86)}, bad), "number of divisions is " + std::to_string(bad) + ", outside 4..200");
}

}  // namespace
}  // namespace dts::physics
