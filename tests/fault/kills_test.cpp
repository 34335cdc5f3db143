// SPDX-License-Identifier: Apache-2.0
// SIGKILL at random moments of a recording. `scripts/fault kills 1000` is the long form.
#include "fault/kills.h"

#include <gtest/gtest.h>

#include "fault/child_process.h"
#include "fault/pair_kills.h"
#include "fault/recorded_session.h"
#include "fault/rigs.h"

namespace dts::fault {
namespace {

/// A daemon that was killed at once and is back within the second: the next session must not get the name of the last.
TEST(Restart, SeveralWithinASecond_EverySessionStarts) {
  const TemporaryFolder folder;
  core::SystemClock clock;
  for (int start = 0; start < 6; ++start) {  // some tens of milliseconds each
    auto session = RecordedSession::open(folder.path(), floor4_rig(), clock);
    ASSERT_TRUE(session);
    EXPECT_EQ((*session)->start().refusal, "");
  }
}

TEST(Kill, AtRandomMoments_LosesAtMostASecondAndNothingBeforeIt) {
  RecordProperty("requirement", "REC-2");
  const Reference reference = Reference::compute(floor16_rig(), 60.0);
  KillLine line(reference, std::random_device()());

  for (int round = 0; round < 6; ++round) {
    const Killed killed = line.run_round(2.0);
    EXPECT_EQ(killed.problem, "") << "round " << round << ": " << killed.recorded_s << " s recorded, " << killed.lost_s
                                  << " s lost, of which " << killed.published_lost_s << " s had been published";
  }
}

TEST(Kill, OfASessionOverTwoRigs_ContinuesOnBothAndLeavesBothRecordingsWhole) {
  RecordProperty("requirement", "SES-6");
  const Reference reference = Reference::compute(floor4_rig(), 120.0);
  PairKills pair{std::random_device()()};

  for (int round = 0; round < 4; ++round) ASSERT_EQ(pair.run_round(1.0), "") << "round " << round;

  EXPECT_EQ(pair.finish(reference), "");
}

}  // namespace
}  // namespace dts::fault
