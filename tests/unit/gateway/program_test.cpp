// SPDX-License-Identifier: Apache-2.0
// The gateway's configuration file, which the command line is read beside.
#include "gateway/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "cli/exit_status.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;

class ProgramTest : public ::testing::Test {
 protected:
  /// With `text` as the configuration.
  int run_with(const std::string& text, std::vector<std::string> words) {
    std::ofstream(file_) << text;
    words.insert(words.begin(), {"--config", file_});
    cli::Console console{.out = out_, .talk = talk_};
    return run(words, console);
  }

  testing::TemporaryDirectory directory_;
  std::string file_ = (directory_.path() / "gateway.toml").string();
  std::ostringstream out_;
  std::ostringstream talk_;
};

TEST_F(ProgramTest, WordThatServeDoesNotKnow_IsRefusedByName) {
  EXPECT_EQ(run_with("[serve]\nlocal_role = \"none\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("unknown key 'serve.local_role'"));

  EXPECT_EQ(run_with("local-role = \"none\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("unknown key 'local-role'"));

  EXPECT_EQ(run_with("[server]\nlocal-role = \"none\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("unknown key 'server."));  // CLI11 names the table's start, or its first key
}

TEST_F(ProgramTest, TableOfServe_DoesNotServeWhenAnotherCommandIsGiven) {
  EXPECT_EQ(run_with("[serve]\nlisten = \"nowhere\"\n", {"man"}), cli::kOk) << talk_.str();

  EXPECT_THAT(out_.str(), HasSubstr(".TH"));
}

TEST_F(ProgramTest, TableOfServe_IsRead) {
  EXPECT_EQ(run_with("[serve]\nlisten = \"nowhere\"\n", {"serve"}), cli::kUsage);

  EXPECT_THAT(talk_.str(), HasSubstr("cannot listen on 'nowhere'"));
}

}  // namespace
}  // namespace dts::gateway
