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

/// The paragraph about the methods, for trials at these rates.
std::string methods(SessionData session, const std::string& device_uri, const std::vector<double>& rates_hz = {100.0}) {
  session.facts.emplace();
  session.facts->kind = "floor";
  session.facts->device_uri = device_uri;
  session.facts->device_model = "USB-6008";
  std::vector<TrialData> trials;
  for (const double rate_hz : rates_hz) {
    TrialData& trial = trials.emplace_back();
    trial.recorded.cop.rate_hz = rate_hz;
    trial.analysis.emplace();
    trial.analysis->rate_hz = 100.0;
  }
  return methods_of(session, trials).value().items.front();
}

TEST(Methods, ThePlatform_IsTheInstrumentAndNotItsDataAcquisition) {
  EXPECT_THAT(methods({}, "ni6008:"),
              HasSubstr("was recorded with a bending plate, data acquisition by USB-6008, at 100.0 Hz and analysed"));
  EXPECT_THAT(methods({.is_force_plate = true}, "ni6008:"), HasSubstr("was recorded with a force plate, data"));
}

TEST(Methods, SimulatedData_AreNotDescribedAsAMeasurement) {
  RecordProperty("requirement", "REP-3");
  const std::string text = methods({.is_force_plate = true}, "sim:floor");
  EXPECT_THAT(text, HasSubstr("synthetic, no person was measured: the centre of pressure was simulated for a force plate"));
  EXPECT_THAT(text, Not(HasSubstr("was recorded")));
}

TEST(Methods, RatesOfTrialsThatDiffer_AreAllListed) {
  EXPECT_THAT(methods({}, "ni6008:", {100.0, 1000.0, 100.0}), HasSubstr("at 100.0 and 1000 Hz and analysed"));
}

}  // namespace
}  // namespace dts::report
