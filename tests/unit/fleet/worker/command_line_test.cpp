// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "cli/exit_status.h"
#include "fleet/worker/program.h"

namespace dts::fleet::worker {
namespace {

using ::testing::HasSubstr;

class CommandLineTest : public ::testing::Test {
 protected:
  int run_with(const std::vector<std::string>& words) {
    cli::Console console{.out = out_, .talk = talk_};
    return run(words, console);
  }

  std::ostringstream out_{};
  std::ostringstream talk_{};
};

TEST_F(CommandLineTest, Help_StartsWithExamples) {
  EXPECT_EQ(run_with({"--help"}), cli::kOk);
  EXPECT_THAT(out_.str(), HasSubstr("Common tasks:\n  dts-worker run --config /etc/dtsd/worker.toml\n"));
}

TEST_F(CommandLineTest, Run_NeedsAConfiguration) {
  EXPECT_EQ(run_with({"run"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("--config"));
}

TEST_F(CommandLineTest, ConfigurationThatCannotBeRead_IsNamed) {
  EXPECT_EQ(run_with({"run", "--config", "/none/worker.toml"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("/none/worker.toml"));
}

TEST_F(CommandLineTest, Manual_NamesTheConfiguration) {
  EXPECT_EQ(run_with({"man"}), cli::kOk);
  EXPECT_THAT(out_.str(), HasSubstr("/etc/dtsd/worker.toml"));
}

}  // namespace
}  // namespace dts::fleet::worker
