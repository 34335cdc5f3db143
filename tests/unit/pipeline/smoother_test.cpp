// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/smoother.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/block.h"
#include "core/special_numbers.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
using core::quality::kSubstituted;

Smoother smoother(double hz) {
  Smoother made;
  made.prepare(rate_hz(hz));
  return made;
}

/// `scans` scans of one value.
const ReachSample& add(Smoother& to, double mm, int scans = 1, std::uint8_t bits = 0) {
  for (int i = 0; i < scans; ++i) to.add(mm, 10.0 * mm, -mm, bits);
  return to.sample();
}

TEST(Smoother, MissingValue_IsBridgedByTheLastOne) {
  Smoother at_100 = smoother(100.0);
  for (const double mm : {1.0, 2.0, 4.0, 8.0, 16.0, kNaN}) add(at_100, mm);

  EXPECT_NEAR(at_100.sample().mm, (2.0 + 4.0 + 8.0 + 16.0 + 16.0) / 5.0, 1e-12);
  EXPECT_NEAR(at_100.sample().ratio, 92.0, 1e-12);
  EXPECT_NEAR(at_100.sample().twist, -9.2, 1e-12);
}

TEST(Smoother, BlockOf15Scans_NeedsHalfOfThem) {
  for (const auto& [missing, expected_mm] : {std::pair{7, 2.0}, {8, 1.0}}) {
    Smoother at_1500 = smoother(1500.0);
    add(at_1500, 1.0, 75);
    add(at_1500, kNaN, missing);
    EXPECT_NEAR(add(at_1500, 2.0, 15 - missing).mm, (4.0 + expected_mm) / 5.0, 1e-12);
  }
  for (const int doubtful : {7, 8}) {
    Smoother at_1500 = smoother(1500.0);
    add(at_1500, 1.0, 75 - doubtful);
    EXPECT_EQ(add(at_1500, 1.0, doubtful, kSubstituted).is_substituted, doubtful == 8);
    EXPECT_EQ(add(at_1500, 1.0, 60).is_substituted, doubtful == 8);
    EXPECT_FALSE(add(at_1500, 1.0, 15).is_substituted);
  }
}

TEST(Smoother, SilenceOfMoreThan250Ms_IsNotKnownUntilTheWindowIsFull) {
  for (const auto& [hz, scans] : {std::pair{100.0, 1}, {1500.0, 15}}) {
    Smoother made = smoother(hz);
    EXPECT_FALSE(add(made, 1.0, 4 * scans).is_known);
    EXPECT_TRUE(add(made, 1.0, scans).is_known);
    EXPECT_TRUE(add(made, kNaN, 25 * scans).is_known);
    EXPECT_FALSE(add(made, kNaN, scans).is_known);
    EXPECT_FALSE(add(made, 1.0, 4 * scans).is_known);
    EXPECT_TRUE(add(made, 1.0, scans).is_known);
  }
}

/// Counts beyond a block would never complete one again.
TEST(Smoother, StateBeyondItsLimits_IsRefused) {
  const auto accepts = [](std::size_t number, double value) {
    std::vector<double> state(Smoother::kStateSize);
    state[number] = value;
    StateReader reader(state, state.size());
    Smoother restored = smoother(1500.0);
    restored.restore(reader);
    return reader.is_right();
  };
  constexpr double kAny = 1e15;
  const std::vector<double> largest{15e6, 15e6, 15e6, 14, 14, 14, 14, 1, 4, kAny, 5, 1e6, 1e6, 1e6, 1, 1, 1};
  for (std::size_t number = 0; number < largest.size(); ++number) {
    EXPECT_TRUE(accepts(number, largest[number])) << number;
    EXPECT_EQ(accepts(number, largest[number] + 1.0), largest[number] == kAny) << number;
  }
}

}  // namespace
}  // namespace dts::pipeline
