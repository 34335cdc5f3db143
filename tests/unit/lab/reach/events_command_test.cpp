// SPDX-License-Identifier: Apache-2.0
#include "unit/lab/reach/trial_folder.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::reach {
namespace {

using testing::HasSubstr;

class ReachEventsTest : public RunTest {
 protected:
  [[nodiscard]] std::vector<std::string> written() const {
    std::ifstream file(path("pred.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  TrialFolder folder_;
};

TEST_F(ReachEventsTest, Trials_GetALineEachAsTheContractSays) {
  ASSERT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv")}), cli::kOk) << talk();

  const auto lines = written();
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg");
  EXPECT_THAT(lines[1], testing::MatchesRegex("P,1,1\\.[0-9]+,1\\.[0-9]+,[23]\\.[0-9]+,[0-9.]+,[0-9.]+,[0-9.]+,,,,,"));
  EXPECT_EQ(lines[2], "P,2,,,,,,,,,,,");
  EXPECT_THAT(out(), HasSubstr("3 trials, 2 with a reach"));
}

TEST_F(ReachEventsTest, Json_Counts) {
  ASSERT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv"), "--json"}), cli::kOk);

  EXPECT_EQ(json()["trials"], 3);
  EXPECT_EQ(json()["reaches"], 2);
}

TEST_F(ReachEventsTest, BadInput_IsSaidAndNothingWritten) {
  folder_.write("P.csv", "trial,v1,v2,v3,v4\n1,1,1,1,one\n");

  EXPECT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv")}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("P.csv:2:9"));
  EXPECT_TRUE(written().empty());
}

TEST_F(ReachEventsTest, PlotOfAnUnknownKind_IsRefusedBeforeAnyWork) {
  EXPECT_EQ(run_with({"reach", "events", folder_.path(), "--out", path("pred.csv"), "--plot", "picture.doc"}), cli::kUsage);
  EXPECT_TRUE(written().empty());
}

TEST_F(ReachEventsTest, OutThatCannotBeWritten_Fails) {
  EXPECT_NE(run_with({"reach", "events", folder_.path(), "--out", "/nowhere/at/all/pred.csv"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("/nowhere/at/all"));
}

}  // namespace
}  // namespace dts::lab::reach
