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

std::vector<ReachStep> steps_of(const std::vector<ReachEvent>& events) {
  std::vector<ReachStep> steps;
  for (const ReachEvent& event : events) steps.push_back(event.step);
  return steps;
}

double seconds(core::ScanIndex scan, double hz = 100.0) { return static_cast<double>(scan.value) / hz; }

TEST(Reach, OneReach_IsMeasured) {
  const MadeReach made{.start_s = 2.0, .dip_mm = 0.4, .rise_mm = 1.5};

  const auto finals = finals_of(reaches_of(transient_of({.reaches = {made}}, 6.0)));

  ASSERT_EQ(finals.size(), 1U);
  const ReachEvent& reach = finals[0];
  EXPECT_EQ(reach.number, 1U);
  EXPECT_EQ(reach.flags, 0);
  EXPECT_NEAR(seconds(reach.p1.scan), 2.05, 0.05);
  EXPECT_NEAR(seconds(reach.p2.scan), 2.17, 0.05);
  EXPECT_NEAR(reach.p1.value_mm, 3.7, 0.02);
  EXPECT_NEAR(reach.p2.value_mm, 3.32, 0.04);
  EXPECT_NEAR(reach.p3.value_mm, 5.2, 0.03);
  EXPECT_GE(seconds(reach.p3.scan), made.highest_s() - 0.2);
  EXPECT_LE(seconds(reach.p3.scan), made.highest_s() + made.hold_s + 0.1);
  EXPECT_NEAR(reach.features.rest_ratio, -0.2, 0.01);
  EXPECT_NEAR(reach.features.ratio_change, 0.105, 0.01);
  EXPECT_NEAR(reach.features.hold_mm, 1.45, 0.1);
  EXPECT_NEAR(reach.features.rise_s, seconds(reach.p3.scan) - seconds(reach.p2.scan), 1e-9);
  EXPECT_LT(reach.features.smoothness, -1.0);
  EXPECT_GT(reach.features.smoothness, -6.0);
}

TEST(Reach, Steps_AreToldInOrderAndInTime) {
  const auto events = reaches_of(transient_of({.reaches = {{.hold_s = 1.5}}}, 8.0));

  ASSERT_GE(events.size(), 4U);
  EXPECT_EQ(events.front().step, ReachStep::P1);
  EXPECT_EQ(events[1].step, ReachStep::P2);
  EXPECT_EQ(events.back().step, ReachStep::Final);
  for (const ReachEvent& event : events) {
    const core::ReachPoint& point = event.step == ReachStep::P2 ? event.p2 : event.p3;
    if (event.step == ReachStep::P1) continue;
    EXPECT_LE(seconds(event.scan) - seconds(point.scan), event.step == ReachStep::Final ? 0.65 : 0.06 + 1e-9);
  }
  EXPECT_TRUE(std::isnan(events.front().features.p2_mm));  // not known yet
}

TEST(Reach, At1500Hz_FindsTheSameAsAt100) {
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

TEST(Reach, NobodyOnTheSeat_TellsNothing) { EXPECT_THAT(reaches_of(transient_of({.rest_mm = 0.0}, 20.0)), testing::IsEmpty()); }

TEST(Reach, QuietSitting_TellsNothing) {
  for (const double noise_mm : {0.012, 0.025}) {
    EXPECT_THAT(reaches_of(transient_of({.noise_mm = noise_mm}, 60.0)), testing::IsEmpty()) << noise_mm;
  }
}

TEST(Reach, SlowDrift_TellsNothingAndIsFollowed) {
  const SeatedPerson person{.reaches = {{.start_s = 30.0}}, .drift_mm_per_s = 0.01};

  const auto finals = finals_of(reaches_of(transient_of(person, 34.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_NEAR(finals[0].p1.value_mm, 4.0, 0.03);
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

TEST(Reach, ArmAlone_IsMinor) {
  const auto finals = finals_of(reaches_of(transient_of({.reaches = {{.dip_mm = 0.0, .rise_mm = 0.14}}}, 6.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_EQ(finals[0].flags, flag::kMinor | flag::kNoInitiation);
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

TEST(Reach, WithoutADip_HasP2AtP1) {
  const auto finals = finals_of(reaches_of(transient_of({.reaches = {{.dip_mm = 0.0}}}, 6.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_EQ(finals[0].flags, flag::kNoInitiation);
  EXPECT_EQ(finals[0].p1.scan, finals[0].p2.scan);
  EXPECT_EQ(finals[0].features.d1_mm(), 0.0);
}

TEST(Reach, SecondReachFromHalfWay_ResumesTheFirst) {
  const SeatedPerson person{.reaches = {{.start_s = 2.0, .rise_mm = 1.0, .hold_s = 1.5}, {.start_s = 4.3, .dip_mm = 0.0, .rise_mm = 1.0}}};

  const auto finals = finals_of(reaches_of(transient_of(person, 9.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_NE(finals[0].flags & flag::kResumed, 0);
  EXPECT_EQ(finals[0].resumed, 1);
}

TEST(Reach, TwoReaches_AreTwo) {
  const SeatedPerson person{.reaches = {{.start_s = 2.0}, {.start_s = 6.0, .rise_mm = 0.8}}};

  const auto finals = finals_of(reaches_of(transient_of(person, 10.0)));

  ASSERT_EQ(finals.size(), 2U);
  EXPECT_NEAR(finals[0].features.d2_mm(), 1.5, 0.05);
  EXPECT_NEAR(finals[1].features.d2_mm(), 0.8, 0.05);
  EXPECT_EQ(finals[1].number, finals[0].number + 1);
}

TEST(Reach, ShiftOfPostureUpwards_EndsAndTheNextReachStartsFromThere) {
  const double shift_mm = 0.25;  // more than a minor reach, less than a twentieth of the largest
  MadeReach shift{.start_s = 3.0, .dip_mm = 0.0, .rise_mm = shift_mm, .forward_s = 0.5, .hold_s = 100.0};

  const auto finals = finals_of(reaches_of(transient_of({.reaches = {shift, {.start_s = 9.0, .rise_mm = 1.5}}}, 13.0)));

  ASSERT_EQ(finals.size(), 2U);
  EXPECT_EQ(finals[1].number, 2U);
  EXPECT_NEAR(finals[1].features.p1_mm, 3.7 + shift_mm, 0.03);
  EXPECT_NEAR(finals[1].features.d2_mm(), 1.5, 0.05);
}

TEST(Reach, LongHold_DoesNotChangeTheFeatures) {
  const auto finals = finals_of(reaches_of(transient_of({.reaches = {{.hold_s = 4.0}}}, 11.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_NEAR(finals[0].features.d2_mm(), 1.5, 0.05);
  EXPECT_EQ(finals[0].flags & ~flag::kResumed, 0);
}

TEST(Reach, NeverComingBack_TimesOut) {
  const auto finals = finals_of(reaches_of(transient_of({.reaches = {{.hold_s = 20.0}}}, 15.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_NE(finals[0].flags & flag::kTimeout, 0);
}

TEST(Reach, FidgetBefore_DoesNotHideTheReach) {
  const SeatedPerson person{.reaches = {{.start_s = 1.0, .dip_mm = 0.05, .rise_mm = 0.10, .forward_s = 0.25}, {.start_s = 2.4}}};

  const auto found = main_reach(reaches_of(transient_of(person, 7.0)));

  ASSERT_TRUE(found);
  EXPECT_NEAR(found->features.d2_mm(), 1.5, 0.06);
  EXPECT_NEAR(seconds(found->p1.scan), 2.45, 0.08);
  EXPECT_NEAR(seconds(found->p2.scan), 2.57, 0.05);
}

TEST(Reach, ShiftOfPosture_IsADipOnlyAndTheNextReachIsFound) {
  Signal signal = transient_of({.reaches = {{.start_s = 6.0}}}, 10.0);
  for (std::size_t i = 300; i < signal.scans(); ++i) signal.values[0][i] -= 0.3;

  const auto finals = finals_of(reaches_of(signal));

  ASSERT_EQ(finals.size(), 2U);
  EXPECT_EQ(finals[0].flags, flag::kDipOnly | flag::kMinor);
  EXPECT_EQ(finals[1].flags, 0);
  EXPECT_NEAR(finals[1].features.p1_mm, 3.4, 0.02);
  EXPECT_EQ(main_reach(finals)->number, finals[1].number);
}

TEST(Reach, SittingDownAndStandingUp_AreNoReaches) {
  const auto events = reaches_of(transient_of({.sits_down_s = 2.0, .stands_up_s = 10.0}, 14.0));

  EXPECT_THAT(finals_of(events), testing::IsEmpty());
}

TEST(Reach, StandingUpAfterTheHighestPoint_IsSaid) {
  const auto finals = finals_of(reaches_of(transient_of({.reaches = {{}}, .stands_up_s = 3.6}, 6.0)));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_NE(finals[0].flags & flag::kStoodUp, 0);
}

TEST(Reach, Untared_IsSaid) {
  Signal signal = transient_of({.reaches = {{}}}, 6.0);
  for (auto& bits : signal.bits) std::ranges::fill(bits, core::quality::kUntared);

  const auto finals = finals_of(reaches_of(signal));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_EQ(finals[0].flags, flag::kUntared);
}

TEST(Reach, SensorsSilentForAMoment_AreBridged) {
  Signal signal = transient_of({.reaches = {{}}}, 6.0);
  for (std::size_t i = 290; i < 300; ++i) signal.values[0][i] = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(finals_of(reaches_of(signal)).size(), 1U);
}

TEST(Reach, SensorsSilentForLong_CancelTheReach) {
  Signal signal = transient_of({.reaches = {{}}}, 6.0);
  for (std::size_t i = 250; i < 320; ++i) signal.values[0][i] = std::numeric_limits<double>::quiet_NaN();

  const auto events = reaches_of(signal);

  EXPECT_THAT(finals_of(events), testing::IsEmpty());
  EXPECT_THAT(steps_of(events), testing::Contains(ReachStep::Cancelled));
}

TEST(Reach, ChannelsThatAreNoTransient_AreRefused) {
  StageSurroundings surroundings(chair_rig());
  const auto stage = surroundings.make({.id = "reach", .options = {}});

  EXPECT_FALSE(stage->prepare(deflections_of({}, 0.0).format, 64));
  EXPECT_FALSE(stage->prepare(transient_of({}, 0.0, 50.0).format, 64));
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

TEST_F(ReachOfSensors, AllWell_HasNoFlags) {
  const auto found = finals(deflections());

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].flags, 0);
}

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
  for (const auto& [one, other] : {std::pair{0U, 2U}, {1U, 3U}, {0U, 3U}, {1U, 2U}}) {
    Signal signal = deflections();
    std::swap(signal.values[one], signal.values[other]);

    const auto found = finals(signal);

    ASSERT_EQ(found.size(), 1U) << one << " and " << other;
    EXPECT_NE(found[0].flags & flag::kImplausible, 0) << one << " and " << other;
  }
}

TEST_F(ReachOfSensors, LeftAndRightSwapped_ChangeNothing) {
  Signal signal = deflections();
  std::swap(signal.values[0], signal.values[1]);

  const auto found = finals(signal);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].flags, 0);
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
