// SPDX-License-Identifier: Apache-2.0
#include "unit/lab/reach/trial_folder.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::reach {
namespace {

using testing::HasSubstr;

class ReachEventsTest : public RunTest {
 protected:
  TrialFolder folder_;
};

TEST_F(ReachEventsTest, Trials_GetALineEachAsTheContractSays) {
  ASSERT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv")}), cli::kOk) << talk();

  const std::string number = "[0-9]+\\.[0-9]{4}";
  const std::string reach = ",1," + number + "," + number + "," + number + "," + number + "," + number + "," + number + ",,,,,\n";
  EXPECT_THAT(content("pred.csv"),
              testing::MatchesRegex("subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg\n"
                                    "P" +
                                    reach + "P,2,,,,,,,,,,,\nQ" + reach));
  EXPECT_THAT(out(), HasSubstr("3 trials, 2 with a reach"));
  ASSERT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv"), "--json"}), cli::kOk);
  EXPECT_EQ(json(), (nlohmann::json{{"doubtful", 0}, {"file", path("pred.csv")}, {"minor", 0}, {"reaches", 2}, {"trials", 3}}));
}

TEST_F(ReachEventsTest, BadInput_IsSaidAndNothingWritten) {
  folder_.write("P.csv", "trial,v1,v2,v3,v4\n1,1,1,1,one\n");

  EXPECT_THAT(refusal_of({"reach", "events", folder_.path(), "--out", path("pred.csv")}), HasSubstr("P.csv:2:9"));
  EXPECT_EQ(content("pred.csv"), "");
}

TEST_F(ReachEventsTest, PlotOfAnUnknownKind_IsRefusedBeforeAnyWork) {
  EXPECT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv"), "--plot", "picture.doc"}), cli::kUsage);
  EXPECT_EQ(content("pred.csv"), "");
}

TEST_F(ReachEventsTest, OutThatCannotBeWritten_Fails) {
  EXPECT_NE(run_with({"reach", "events", folder_.path(), "--out", "/nowhere/at/all/pred.csv"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("/nowhere/at/all"));
}

}  // namespace
}  // namespace dts::lab::reach
