// SPDX-License-Identifier: Apache-2.0
#include "accuracy/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dts::accuracy {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A truth that moves, and a COP that repeats it `delay_scans` later; 100 Hz, 12 s.
RigCapture delayed_by(double delay_scans) {
  RigCapture rig;
  for (Track* track : {&rig.cop, &rig.truth}) {
    track->rate_hz = 100.0;
    track->doubts.assign(1200, 0);
    for (auto& column : track->columns) column.assign(1200, 0.0);
  }
  rig.cop.delay_s = delay_scans / 100.0;
  for (std::size_t i = 0; i < 1200; ++i) {
    const auto scan = static_cast<double>(i);
    rig.truth.columns[0][i] = 0.01 * scan;
    rig.truth.columns[1][i] = std::sin(0.01 * scan);
    rig.truth.columns[2][i] = 600.0;
    rig.cop.columns[0][i] = 0.01 * (scan - delay_scans);
    rig.cop.columns[1][i] = std::sin(0.01 * (scan - delay_scans));
    rig.cop.columns[2][i] = 606.0;
  }
  return rig;
}

Case from_four_and_a_half_for(double seconds) { return stance_case(thesis_daq(), "poly3", {}, seconds); }

TEST(Evaluate, DelayOfWholeAndHalfScans_IsTakenOut) {
  for (const double delay_scans : {0.0, 1.0, 14.5}) {
    const Evaluation e = evaluate(from_four_and_a_half_for(6.0), delayed_by(delay_scans));

    EXPECT_LT(e.ml.rmse_mm, 1e-9) << delay_scans;
    EXPECT_LT(e.ap.rmse_mm, 1e-4) << delay_scans << ": linear interpolation of a slow sine";
    EXPECT_NEAR(e.load_error, 0.01, 1e-12);
    // Scans 450..1050; a window of 2 delay + 1 scans must lie inside.
    EXPECT_EQ(e.expected_scans, 601U - static_cast<std::size_t>(2.0 * delay_scans));
    EXPECT_EQ(e.compared_scans, e.expected_scans);
  }
}

TEST(Evaluate, DelayThatIsNotPublished_Shows) {
  RigCapture rig = delayed_by(10.0);
  rig.cop.delay_s = 0.0;

  const Evaluation e = evaluate(from_four_and_a_half_for(6.0), rig);

  EXPECT_NEAR(e.ml.offset_mm, -0.1, 1e-9);
}

TEST(Evaluate, MissingValues_AreCountedAndNotCompared) {
  RigCapture rig = delayed_by(1.0);
  rig.cop.columns[1][700] = kNaN;
  rig.truth.columns[0][800] = kNaN;
  rig.lost_on_the_way = 3;
  rig.lost_before_pipeline = 4;

  const Evaluation e = evaluate(from_four_and_a_half_for(6.0), rig);

  EXPECT_EQ(e.expected_scans - e.compared_scans, 2U);
  EXPECT_EQ(e.lost_scans, 7U);
}

TEST(Evaluate, QualityBits_CountInsideTheTimeOnly) {
  RigCapture rig = delayed_by(1.0);
  rig.cop.doubts[100] = 1;
  EXPECT_EQ(evaluate(from_four_and_a_half_for(6.0), rig).doubts, 0);

  rig.cop.doubts[1000] = 2;
  EXPECT_EQ(evaluate(from_four_and_a_half_for(6.0), rig).doubts, 2);
}

TEST(Evaluate, NothingReceived_ComparesNothing) {
  RigCapture rig;
  rig.cop.rate_hz = rig.truth.rate_hz = 100.0;

  const Evaluation e = evaluate(from_four_and_a_half_for(6.0), rig);

  EXPECT_EQ(e.expected_scans, 601U);
  EXPECT_EQ(e.compared_scans, 0U);
}

TEST(LargestTruthError, WorstScanCounts) {
  const Case wanted = from_four_and_a_half_for(6.0);
  RigCapture rig = delayed_by(1.0);
  RecordingFile file{.rate_hz = 100.0, .locus = {}};
  for (std::size_t i = 450; i <= 1050; ++i) {
    file.locus.ml_mm.push_back(rig.truth.columns[0][i]);
    file.locus.ap_mm.push_back(rig.truth.columns[1][i]);
  }
  EXPECT_LT(largest_truth_error_mm(wanted, rig, file), 1e-9);

  rig.truth.columns[1][900] += 0.25;
  EXPECT_NEAR(largest_truth_error_mm(wanted, rig, file), 0.25, 1e-9);

  rig.truth.columns[1][900] = kNaN;
  EXPECT_TRUE(std::isinf(largest_truth_error_mm(wanted, rig, file)));
}

}  // namespace
}  // namespace dts::accuracy
