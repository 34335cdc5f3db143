// SPDX-License-Identifier: Apache-2.0
// What a report says of a session on a force plate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "report/page_parts.h"
#include "report/recorded_definitions.h"

namespace dts::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string balance_board() {
  std::ostringstream text;
  text << std::ifstream(std::string(DTS_SOURCE_DIR) + "/config/rigs/balance-board.toml").rdbuf();
  return text.str();
}

TEST(ReportOfAForcePlate, TheRecordedRig_IsKnownAsOne) {
  record::SessionFacts facts;
  facts.rig_definition = balance_board();

  const RecordedRig rig = recorded_rig(facts);

  EXPECT_TRUE(rig.is_force_plate);
  EXPECT_FALSE(rig.corrects_two_feet);
  ASSERT_TRUE(rig.plate);
  EXPECT_EQ(rig.plate->a_mm, 500.0);
  EXPECT_EQ(rig.plate->b_mm, 300.0);
}

TEST(ReportOfAForcePlate, ItsAccuracy_IsNotThatOfABendingPlate) {
  SessionData session;
  EXPECT_THAT(accuracy_note(session), HasSubstr("1.05 mm"));
  session.is_force_plate = true;
  EXPECT_THAT(accuracy_note(session), HasSubstr("see its maker's data"));
  EXPECT_THAT(accuracy_note(session), Not(HasSubstr("1.05 mm")));
}

}  // namespace
}  // namespace dts::report
