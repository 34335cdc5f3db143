// SPDX-License-Identifier: Apache-2.0
// Where a reach begins: after a short rest, at once after another one, soon after somebody sat down.
#include <gmock/gmock.h>

#include "pipeline/stages/reach.h"
#include "unit/pipeline/chair_chain.h"

namespace dts::pipeline {
namespace {

namespace flag = core::reach_flag;
using core::ReachEvent;

double seconds_of(core::ScanIndex scan) { return static_cast<double>(scan.value) / 100.0; }

/// A recording that begins just before the reach.
TEST(ReachRest, ShortRestAtTheBeginning_IsARest) {
  for (const double start_s : {0.25, 0.35, 0.45, 0.55, 0.65}) {
    const auto finals = finals_of(reaches_of(transient_of({.reaches = {{.start_s = start_s}}}, 5.0)));

    ASSERT_EQ(finals.size(), 1U) << start_s;
    EXPECT_EQ(finals[0].flags & ~flag::kBaselineUncertain, 0) << start_s;
    EXPECT_NEAR(seconds_of(finals[0].p1.scan), start_s + 0.05, 0.06) << start_s;
    EXPECT_NEAR(finals[0].p1.value_mm, 3.7, 0.03) << start_s;
    EXPECT_NEAR(finals[0].p2.value_mm, 3.32, 0.04) << start_s;
    EXPECT_NEAR(finals[0].features.d2_mm(), 1.5, 0.05) << start_s;
  }
}

/// The search for a weak dip ends where somebody sat down: an empty seat is no dip.
TEST(ReachRest, RiseSoonAfterTheBeginning_HasNoDipFromBeforeIt) {
  for (const double start_s : {0.3, 0.4, 0.5, 0.6}) {
    const MadeReach made{.start_s = start_s, .dip_mm = 0.0, .forward_s = 0.5};

    const auto from_first_sample = finals_of(reaches_of(transient_of({.reaches = {made}}, 5.0)));
    const auto after_sitting_down =
        finals_of(reaches_of(transient_of({.reaches = {{.start_s = 2.0 + start_s, .dip_mm = 0.0}}, .sits_down_s = 2.0}, 7.0)));

    ASSERT_EQ(from_first_sample.size(), 1U) << start_s;
    EXPECT_GT(from_first_sample[0].p2.value_mm, 3.6) << start_s;
    for (const ReachEvent& reach : after_sitting_down) EXPECT_GT(reach.p2.value_mm, 3.6) << start_s;
  }
}

/// A recording that begins while the trunk is bent: its return is no reach, and no shift of posture either.
TEST(ReachRest, RecordingThatBeginsAtTheTarget_TellsNothingOfIt) {
  const MadeReach whole{.start_s = 2.0, .hold_s = 0.3};
  const auto signal = transient_of({.reaches = {whole, {.start_s = 8.0}}}, 12.0);
  Signal late = from(signal, static_cast<std::size_t>(whole.highest_s() * 100.0));
  late.first_scan = 0;

  const auto finals = finals_of(reaches_of(late));

  ASSERT_EQ(finals.size(), 1U);
  EXPECT_NEAR(seconds_of(finals[0].p2.scan) + whole.highest_s(), 8.17, 0.06);
  EXPECT_NEAR(finals[0].features.d2_mm(), 1.5, 0.05);
}

}  // namespace
}  // namespace dts::pipeline
