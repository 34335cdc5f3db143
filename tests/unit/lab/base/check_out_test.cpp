// SPDX-License-Identifier: Apache-2.0
#include "lab/base/problems.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

/// What is said of writing to `out`, "" if nothing.
std::string refusal(const std::string& out, const std::vector<std::string>& inputs) {
  const auto status = check_out(out, inputs);
  return status ? "" : status.error().what + "; " + status.error().hint;
}

TEST_F(RunTest, OutputThatIsReadUnderAnyName_IsRefused) {
  const std::string model = write("model.toml", "x");
  std::filesystem::create_symlink(model, path("link.toml"));

  for (const std::string& out : {model, path("link.toml"), path("./model.toml")}) {
    EXPECT_EQ(refusal(out, {"", model}), out + " is the input file " + model + "; write to another file");
  }
}

TEST_F(RunTest, OutputOverFilesOfTheTrials_IsRefused) {
  for (const std::string name : {"subjects.csv", "trials.csv", "sensors.csv", "calibration.csv", "A.csv"}) {
    const std::string out = write(name, name == "A.csv" ? "trial,v1,v2,v3,v4\n" : "anything");
    EXPECT_EQ(refusal(out, {directory_}), out + " belongs to the trials in " + directory_.string() + "; write to another file");
  }
}

TEST_F(RunTest, NewOutputAndEarlierResults_AreWritten) {
  EXPECT_EQ(refusal(path("new.csv"), {directory_}), "");
  EXPECT_EQ(refusal(write("pred.csv", "subject,trial,t_p1"), {directory_}), "");
  EXPECT_EQ(refusal("new.csv", {directory_, ""}), "");
}

}  // namespace
}  // namespace dts::lab
