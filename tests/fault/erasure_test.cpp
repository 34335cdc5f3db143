// SPDX-License-Identifier: Apache-2.0
// A process that is killed while it erases a subject, before each of its calls to the disk in turn.
#include "fault/erasure.h"

#include <gtest/gtest.h>

#include "fault/child_process.h"

namespace dts::fault {
namespace {

TEST(Erasure, KilledBeforeEachCallToTheDisk_TheSubjectIsCompleteOrGone) {
  RecordProperty("requirement", "SES-10");
  const TemporaryFolder folder("/dev/shm");
  ErasedFolder erased(folder.path());
  ASSERT_EQ(erased.problem(), "");
  const std::vector<Fault> kills = erased.all_kills();
  ASSERT_EQ(erased.problem(), "");

  std::size_t complete = 0;
  std::size_t gone = 0;
  for (const Fault& kill : kills) {
    const ErasedFolder::Outcome outcome = erased.kill(kill);
    EXPECT_EQ(outcome.problem, "") << to_text(kill);
    EXPECT_TRUE(outcome.was_killed) << to_text(kill);
    complete += outcome.problem.empty() && !outcome.is_gone ? 1 : 0;
    gone += outcome.is_gone ? 1 : 0;
  }

  EXPECT_GT(complete, 0U) << "killed before the erasure was written down";
  EXPECT_GT(gone, complete);
}

}  // namespace
}  // namespace dts::fault
