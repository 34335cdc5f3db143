// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using testing::HasSubstr;

class JudgeCommand : public RunTest {
 protected:
  std::string shipped_ = std::string(DTS_SOURCE_DIR) + "/config/models/trunk-movement.toml";
};

TEST_F(JudgeCommand, ShippedModel_KeepsNineInTenWithFewErrors) {
  ASSERT_EQ(run_with({"reach", "judge", shipped_, "--people", "12", "--trials", "4", "--json"}), cli::kOk) << talk();
  const auto result = json();

  EXPECT_EQ(result["reaches"], 144);
  // 0.93 and 0.998 over sixty people; twelve vary more.
  EXPECT_GE(result["general"]["kept"].get<double>(), 0.85);
  EXPECT_GE(result["general"]["kept_accuracy"].get<double>(), 0.97);
  EXPECT_GE(result["own"]["kept_accuracy"].get<double>(), 0.97);
}

TEST_F(JudgeCommand, Curve_FallsFromEverythingToTheSureReaches) {
  ASSERT_EQ(run_with({"reach", "judge", shipped_, "--people", "6", "--trials", "4", "--spread", "1.5", "--json"}), cli::kOk) << talk();
  const auto result = json();
  const auto& curve = result["curve"];

  for (std::size_t k = 1; k < curve.size(); ++k) {
    EXPECT_GT(curve[k]["limit"], curve[k - 1]["limit"]);
    EXPECT_LE(curve[k]["general"]["kept"], curve[k - 1]["general"]["kept"]);
  }
  EXPECT_GT(curve.front()["general"]["kept"], curve.back()["general"]["kept"]);
  double rejected = 0.0;
  for (const auto& reason : result["rejections"]) {
    rejected += reason["reaches"].get<double>();
    EXPECT_LE(reason["right_without"], reason["reaches"]);
  }
  // A reach may have two reasons.
  EXPECT_GE(rejected + 1e-9, result["reaches"].get<double>() * (1.0 - result["general"]["kept"].get<double>()));
}

TEST_F(JudgeCommand, Table_SaysThatPeopleAreSimulated) {
  ASSERT_EQ(run_with({"reach", "judge", shipped_, "--people", "2", "--trials", "3"}), cli::kOk) << talk();

  EXPECT_THAT(out(), HasSubstr("All people are simulated. 18 reaches"));
}

TEST_F(JudgeCommand, NoModelOrNonsense_Refused) {
  EXPECT_NE(run_with({"reach", "judge", path("none.toml")}), cli::kOk);
  EXPECT_NE(run_with({"reach", "judge", shipped_, "--people", "0"}), cli::kOk);
  EXPECT_NE(run_with({"reach", "judge", shipped_, "--spread", "3"}), cli::kOk);
}

}  // namespace
}  // namespace dts::lab
