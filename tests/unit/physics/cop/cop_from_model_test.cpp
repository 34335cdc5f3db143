// SPDX-License-Identifier: Apache-2.0
// Names of methods and flags, and which rigs an estimator can be made for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "core/special_numbers.h"
#include "physics/cop/cop_estimator.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using core::kNaN;
using test::floor_rig;
using testing::HasSubstr;

TEST(CopMethodName, Known_IsParsedBack) {
  for (const auto method : {CopMethod::Poly3, CopMethod::Thesis, CopMethod::ThesisPerPair, CopMethod::Moment, CopMethod::Model}) {
    EXPECT_EQ(parse_cop_method(to_string(method)), method);
  }
  EXPECT_EQ(parse_cop_method("thesis_per_pair"), CopMethod::ThesisPerPair);
}

TEST(CopMethodName, Unknown_IsRefusedWithTheChoices) {
  for (const char* name : {"", "Poly3", "moments"}) {
    const auto result = parse_cop_method(name);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, core::ErrorCode::InvalidArgument);
    EXPECT_THAT(core::to_string(result.error()), HasSubstr("poly3, thesis, thesis_per_pair, moment or model"));
  }
}

TEST(CopFlags, Text_NamesEachFlag) {
  EXPECT_EQ(cop_flags_text(0), "");
  EXPECT_EQ(cop_flags_text(cop_flag::kNoContact), "no_contact");
  EXPECT_EQ(cop_flags_text(cop_flag::kOutsideArea | cop_flag::kOutsideLoad), "outside_area|outside_load");
}

TEST(CopEstimatorFromModel, SwappedSensors_AreRefusedByName) {
  for (const auto& [one, other] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}, std::pair{0, 3}}) {
    RigModel rig = floor_rig(10.75);
    std::swap(rig.sensors[static_cast<std::size_t>(one)], rig.sensors[static_cast<std::size_t>(other)]);

    const auto result = CopEstimator::from_model(CopMethod::Thesis, rig);

    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().what, HasSubstr("sensor " + std::to_string(one + 1) + " ('w" + std::to_string(other + 1) + "')"));
    EXPECT_THAT(result.error().hint, HasSubstr("w1 left back"));
  }
}

TEST(CopEstimatorFromModel, BadRig_IsRefused) {
  const auto what = [](auto spoil) {
    RigModel rig = floor_rig(10.75);
    spoil(rig);
    const auto result = CopEstimator::from_model(CopMethod::Poly3, rig);
    EXPECT_EQ(result ? core::ErrorCode{} : result.error().code, core::ErrorCode::InvalidArgument);
    return result ? "" : result.error().what;
  };
  for (const std::size_t count : {std::size_t{0}, std::size_t{3}, std::size_t{5}}) {
    EXPECT_THAT(what([&](RigModel& rig) { rig.sensors.resize(count, rig.sensors.front()); }),
                HasSubstr(std::to_string(count) + " sensors"));
  }
  EXPECT_THAT(what([](RigModel& rig) { rig.plate.nu = 0.7; }), HasSubstr("Poisson's ratio is 0.7"));
  EXPECT_THAT(what([](RigModel& rig) { rig.sensors[2].position.x = {kNaN}; }), HasSubstr("sensor"));
}

}  // namespace
}  // namespace dts::physics
