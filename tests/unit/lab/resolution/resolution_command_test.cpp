// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using testing::HasSubstr;

class ResolutionCommand : public RunTest {
 protected:
  double limit_of(const nlohmann::json& setup, const std::string& reaches) {
    return setup["people"][0]["limits"]["any"][reaches]["deg"].get<double>();
  }
};

TEST_F(ResolutionCommand, MoreReaches_ASmallerMovementIsEnough) {
  ASSERT_EQ(run_with({"reach", "resolution", "--noise", "1,60", "--rate", "100", "--people", "1", "--reaches", "6", "--json"}), cli::kOk)
      << talk();
  const auto result = json();

  ASSERT_EQ(result["setups"].size(), 2U);
  EXPECT_EQ(result["is_synthetic"], true);
  const auto& quiet = result["setups"][0];
  EXPECT_GT(limit_of(quiet, "1_reaches"), 0.2);
  EXPECT_LT(limit_of(quiet, "1_reaches"), 15.0);
  EXPECT_LE(limit_of(quiet, "10_reaches"), limit_of(quiet, "1_reaches"));
  EXPECT_EQ(quiet["median"]["any"]["1_reaches"].size(), 1U) << "one person: a median without an interval";
  EXPECT_TRUE(quiet["people"][0]["limits"]["any"]["1_reaches"].contains("lowest_deg")) << "over the reaches";
  const auto noisy = result["setups"][1]["people"][0]["limits"]["any"]["1_reaches"]["deg"];
  EXPECT_NE(noisy, quiet["people"][0]["limits"]["any"]["1_reaches"]["deg"]);
}

TEST_F(ResolutionCommand, SameSeed_SameTable) {
  const std::vector<std::string> words{"reach",    "resolution", "--noise",   "3", "--rate", "100",
                                       "--people", "1",          "--reaches", "5", "--seed", "7"};
  ASSERT_EQ(run_with(words), cli::kOk) << talk();
  const std::string first = out();
  ASSERT_EQ(run_with(words), cli::kOk);

  EXPECT_EQ(out(), first);
  EXPECT_THAT(first, HasSubstr("Smallest turn of the trunk"));
  EXPECT_THAT(first, HasSubstr("synthetic"));
}

TEST_F(ResolutionCommand, Nonsense_Refused) {
  EXPECT_NE(run_with({"reach", "resolution", "--people", "0"}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("number of people"));
  EXPECT_NE(run_with({"reach", "resolution", "--rate", "1"}), cli::kOk);
  EXPECT_NE(run_with({"reach", "resolution", "--noise", "-1"}), cli::kOk);
  EXPECT_NE(run_with({"reach", "resolution", "--plot", "picture.gif"}), cli::kOk);
}

}  // namespace
}  // namespace dts::lab
