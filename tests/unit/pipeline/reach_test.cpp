// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/reach.h"

#include <gmock/gmock.h>

#include "pipeline/main_reach.h"
#include "unit/pipeline/chair_chain.h"

namespace dts::pipeline {
namespace {

namespace flag = core::reach_flag;
using core::ReachEvent;
using core::ReachStep;

double seconds(core::ScanIndex scan, double hz = 100.0) { return static_cast<double>(scan.value) / hz; }

TEST(Reach, At1500Hz_FindsTheSameAsAt100) {
  RecordProperty("requirement", "REACH-4");
  const SeatedPerson person{.noise_mm = 0.002, .reaches = {{.start_s = 2.0}, {.start_s = 6.0, .rise_mm = 0.6}}};

  const auto slow = finals_of(reaches_of(transient_of(person, 10.0)));
  const auto fast = finals_of(reaches_of(transient_of(person, 10.0, 1500.0), 64));

  ASSERT_EQ(slow.size(), 2U);
  ASSERT_EQ(fast.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(seconds(slow[k].p1.scan), seconds(fast[k].p1.scan, 1500.0), 0.021);
    EXPECT_NEAR(seconds(slow[k].p2.scan), seconds(fast[k].p2.scan, 1500.0), 0.021);
    EXPECT_NEAR(slow[k].p3.value_mm, fast[k].p3.value_mm, 0.005);
    EXPECT_NEAR(slow[k].features.d1_mm(), fast[k].features.d1_mm(), 0.01);
    EXPECT_LE(seconds(fast[k].scan, 1500.0) - seconds(fast[k].p3.scan, 1500.0), 0.65);
  }
}

TEST(Reach, DelayOfTheInput_IsTakenOff) {
  Signal signal = transient_of({.reaches = {{}}}, 6.0);
  const auto at_once = finals_of(reaches_of(signal));
  signal.format.delay_ns = 50'000'000;

  const auto late = finals_of(reaches_of(signal));

  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(at_once.at(0).p2.scan.value - late[0].p2.scan.value, 5U);
}

TEST(Reach, QuietSittingOrNobody_TellsNothing) {
  RecordProperty("requirement", "REACH-3");
  for (const double noise_mm : {0.012, 0.025}) {
    EXPECT_THAT(reaches_of(transient_of({.noise_mm = noise_mm}, 60.0)), testing::IsEmpty()) << noise_mm;
    EXPECT_THAT(reaches_of(transient_of({.rest_mm = 0.0, .noise_mm = noise_mm}, 20.0)), testing::IsEmpty()) << noise_mm;
  }
}

/// P1 comes from the older half of the last 0.6 s, 0.5 s behind: a drift of 0.03 mm/s is seen 0.8 s late.
TEST(Reach, SlowDrift_TellsNothingAndIsFollowed) {
  const SeatedPerson person{.noise_mm = 0.0, .reaches = {{.start_s = 30.0}}, .drift_mm_per_s = 0.03};

  const auto events = reaches_of(transient_of(person, 34.0));

  ASSERT_EQ(finals_of(events).size(), 1U);
  EXPECT_NEAR(events[0].p1.value_mm, 3.7 + 0.03 * (seconds(events[0].scan) - 0.8), 0.001);
}

/// The seat bends in proportion to the weight, and so do dip and rise.
TEST(Reach, ChildAndHeavyPerson_AreMeasuredAlike) {
  for (const double weight_kg : {20.0, 130.0}) {
    const double scale = weight_kg / 68.0;
    const SeatedPerson person{.rest_mm = 3.7 * scale, .reaches = {{.dip_mm = 0.4 * scale, .rise_mm = 1.5 * scale}}};

    const auto finals = finals_of(reaches_of(transient_of(person, 6.0)));

    ASSERT_EQ(finals.size(), 1U) << weight_kg;
    EXPECT_EQ(finals[0].flags, 0) << weight_kg;
    EXPECT_NEAR(finals[0].features.d2_mm() / scale, 1.5, 0.07) << weight_kg;
  }
}

/// Less than the threshold, but right before the rise: a weak initiation is one.
TEST(Reach, ShallowDip_IsFoundWithHindsight) {
  const auto finals = finals_of(reaches_of(transient_of({.noise_mm = 0.004, .reaches = {{.dip_mm = 0.045}}}, 6.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_EQ(finals[0].flags, 0);
  EXPECT_NEAR(finals[0].features.d1_mm(), 0.04, 0.012);
  EXPECT_NEAR(seconds(finals[0].p2.scan), 2.15, 0.06);
}

/// The load grows where it is: somebody presses on the seat, or sensors are swapped crosswise.
TEST(Reach, RiseWithoutAShiftOfWeight_IsImplausible) {
  Signal signal = transient_of({.reaches = {{}}}, 6.0);
  std::ranges::fill(signal.values[1], -0.2);

  const auto finals = finals_of(reaches_of(signal));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_EQ(finals[0].flags, flag::kImplausible);
}

TEST(Reach, FidgetBefore_DoesNotHideTheReach) {
  const SeatedPerson person{.reaches = {{.start_s = 1.0, .dip_mm = 0.05, .rise_mm = 0.10, .forward_s = 0.25}, {.start_s = 2.4}}};

  const auto found = main_reach(reaches_of(transient_of(person, 7.0)));

  ASSERT_TRUE(found);
  EXPECT_NEAR(found->features.d2_mm(), 1.5, 0.06);
  EXPECT_NEAR(seconds(found->p1.scan), 2.45, 0.08);
  EXPECT_NEAR(seconds(found->p2.scan), 2.57, 0.05);
}

/// With the stage before: what is wrong with the sensors reaches the reach's flags.
class ReachOfSensors : public testing::Test {
 protected:
  static Signal deflections() { return deflections_of({.reaches = {{}}}, 6.0); }
  static std::vector<ReachEvent> finals(const Signal& deflections) { return finals_of(reaches_of(transient_from(deflections))); }
  static void kill(Signal& signal, std::size_t sensor, std::size_t from, std::uint8_t bits) {
    std::fill(signal.bits[sensor].begin() + static_cast<std::ptrdiff_t>(from), signal.bits[sensor].end(), bits);
  }
};

TEST_F(ReachOfSensors, OneDead_IsMeasuredWithAFlag) {
  for (const std::size_t sensor : {0U, 1U, 2U, 3U}) {
    Signal signal = deflections();
    kill(signal, sensor, 0, core::quality::kStuck);

    const auto found = finals(signal);

    ASSERT_EQ(found.size(), 1U) << sensor;
    EXPECT_EQ(found[0].flags, flag::kSubstituted) << sensor;
    EXPECT_NEAR(found[0].features.d2_mm(), 1.5, 0.06) << sensor;
  }
}

TEST_F(ReachOfSensors, SaturatedAtTheTop_IsSaid) {
  Signal signal = deflections();
  for (std::size_t i = 0; i < signal.scans(); ++i) {
    if (signal.values[0][i] > 5.0) signal.bits[0][i] = core::quality::kOutOfRange;
  }

  const auto found = finals(signal);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].flags, flag::kSubstituted | flag::kSaturated);
}

TEST_F(ReachOfSensors, RowDead_FindsNothing) {
  Signal signal = deflections();
  kill(signal, 0, 0, core::quality::kRail);
  kill(signal, 1, 0, core::quality::kRail);

  EXPECT_THAT(finals(signal), testing::IsEmpty());
}

TEST_F(ReachOfSensors, RearAndFrontSwapped_AreImplausible) {
  RecordProperty("requirement", "REACH-6");
  for (const auto& [one, other] : {std::pair{0U, 2U}, {1U, 3U}, {0U, 3U}, {1U, 2U}}) {
    Signal signal = deflections();
    std::swap(signal.values[one], signal.values[other]);

    const auto found = finals(signal);

    ASSERT_EQ(found.size(), 1U) << one << " and " << other;
    EXPECT_NE(found[0].flags & flag::kImplausible, 0) << one << " and " << other;
  }
}

TEST_F(ReachOfSensors, AllWellOrLeftAndRightSwapped_HasNoFlags) {
  Signal signal = deflections();
  for (int k = 0; k < 2; ++k) {
    const auto found = finals(signal);

    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].flags, 0);
    std::swap(signal.values[0], signal.values[1]);
  }
}

TEST(MainReach, OfSeveral_IsTheLargestThatIsNotMinor) {
  const auto final_of = [](std::uint32_t number, double p3_mm, std::uint16_t flags) {
    ReachEvent event{.step = ReachStep::Final, .number = number, .flags = flags};
    event.features.p2_mm = 3.0;
    event.features.p3_mm = p3_mm;
    return event;
  };
  ReachEvent cancelled = final_of(4, 9.0, 0);
  cancelled.step = ReachStep::Cancelled;

  EXPECT_FALSE(main_reach({}));
  EXPECT_EQ(main_reach(std::vector{final_of(1, 4.0, 0), final_of(2, 5.0, 0), final_of(3, 6.0, flag::kMinor)})->number, 2U);
  EXPECT_EQ(main_reach(std::vector{final_of(1, 4.0, 0), final_of(2, 5.0, 0), final_of(2, 3.5, 0)})->number, 1U);  // replaced
  EXPECT_EQ(main_reach(std::vector{final_of(1, 4.0, 0), final_of(4, 9.0, 0), cancelled})->number, 1U);
  EXPECT_EQ(main_reach(std::vector{final_of(3, 6.0, flag::kMinor)})->number, 3U);
}

}  // namespace
}  // namespace dts::pipeline
