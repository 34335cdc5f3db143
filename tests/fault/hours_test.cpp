// SPDX-License-Identifier: Apache-2.0
// Two minutes of data. `scripts/fault hours 8` is the long form.
#include "fault/hours.h"

#include <gtest/gtest.h>

#include "fault/child_process.h"
#include "support/sanitized.h"
#include "system/daemon_process.h"

namespace dts::fault {
namespace {

TEST(LongRecording, TwoMinutes_FileIsWholeAndMemoryStaysFlat) {
  RecordProperty("requirement", "REC-12");
  const TemporaryFolder folder;

  const LongRecording recorded = record_hours(2.0 / 60.0, folder.path());

  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.scans, 180'000U);
  EXPECT_LT(static_cast<double>(recorded.bytes), 1.03 * recorded.data_bytes);
  EXPECT_NEAR(static_cast<double>(recorded.bytes), recorded.expected_bytes, 0.005 * recorded.data_bytes);
  // A minute of scans is 12 MB: memory that grew with the recording would show.
  if (!test::kIsSanitized) {
    EXPECT_LT(recorded.resident_end_kb - recorded.resident_start_kb, 2048);
  }
}

}  // namespace
}  // namespace dts::fault
