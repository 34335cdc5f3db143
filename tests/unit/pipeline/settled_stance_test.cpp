// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/settled_stance.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace dts::pipeline {
namespace {

class SettledStanceTest : public testing::Test {
 protected:
  SettledStanceTest() { stance_.prepare(core::Rate::from_hz(100.0).value()); }

  /// Returns how many of `scans` scans the person had settled.
  int settled_scans(int scans, double load_n, bool is_possible = true) {
    int settled = 0;
    for (int k = 0; k < scans; ++k) settled += stance_.update(load_n, is_possible) ? 1 : 0;
    return settled;
  }
  void settle() { settled_scans(51, 600.0); }

  SettledStance stance_;
};

TEST_F(SettledStanceTest, PersonSettlesAfterHalfASecondOfAnEvenLoad) {
  EXPECT_EQ(settled_scans(50, 600.0), 0) << "the first scan only shows the load";
  EXPECT_EQ(settled_scans(10, 600.0), 10);
}

TEST_F(SettledStanceTest, ChangingLoad_StartsTheWaitAgain) {
  EXPECT_EQ(settled_scans(50, 600.0), 0);
  EXPECT_EQ(settled_scans(50, 631.0), 0) << "more than 5 %: still stepping on";
  EXPECT_EQ(settled_scans(1, 660.0), 1) << "within 5 %";
}

TEST_F(SettledStanceTest, ImpossiblePosition_NeverSettles) { EXPECT_EQ(settled_scans(500, 600.0, false), 0); }

TEST_F(SettledStanceTest, LoadThatDiffersByAFifth_EndsIt) {
  settle();
  EXPECT_EQ(settled_scans(10, 715.0), 10);
  EXPECT_EQ(settled_scans(1, 485.0), 1);
  EXPECT_EQ(settled_scans(1, 479.0), 0);
  EXPECT_EQ(settled_scans(49, 479.0), 0);
}

TEST_F(SettledStanceTest, ImpossiblePosition_EndsItAfterAQuarterOfASecond) {
  settle();
  EXPECT_EQ(settled_scans(25, 600.0, false), 25);
  EXPECT_EQ(settled_scans(1, 600.0), 1) << "was only for a moment";
  EXPECT_EQ(settled_scans(26, 600.0, false), 25);
  EXPECT_EQ(settled_scans(49, 600.0), 0);
}

TEST_F(SettledStanceTest, NobodyOnThePlate_ForgetsThePerson) {
  settle();
  stance_.reset();
  EXPECT_EQ(settled_scans(50, 600.0), 0);
}

TEST_F(SettledStanceTest, RestoredState_ContinuesLikeTheSavedOne) {
  for (const int before : {0, 20, 51, 60}) {
    stance_.reset();
    settled_scans(before, 600.0);
    std::array<double, SettledStance::kStateSize> state{};
    StateWriter writer(state);
    stance_.save(writer);
    SettledStance other;
    other.prepare(core::Rate::from_hz(100.0).value());
    StateReader reader(state, state.size());
    other.restore(reader);
    ASSERT_TRUE(reader.is_right());
    for (int k = 0; k < 80; ++k) EXPECT_EQ(other.update(600.0, k < 40), stance_.update(600.0, k < 40)) << before << ", " << k;
  }
}

TEST_F(SettledStanceTest, ImpossibleState_IsNoted) {
  using State = std::array<double, SettledStance::kStateSize>;
  for (const State& state : {State{2.0, 0.0, 600.0}, State{0.0, 51.0, 600.0}, State{1.0, 26.0, 600.0}, State{0.0, 0.5, 600.0},
                             State{0.0, 0.0, -1.0}, State{0.0, 0.0, std::numeric_limits<double>::quiet_NaN()}}) {
    StateReader reader(state, state.size());
    stance_.restore(reader);
    EXPECT_FALSE(reader.is_right());
  }
}

}  // namespace
}  // namespace dts::pipeline
