// SPDX-License-Identifier: Apache-2.0
// The gateway's configuration file, which the command line is read beside.
#include "gateway/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

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

TEST_F(ProgramTest, WordThatServeDoesNotKnow_IsToldWithItsFileAndLine) {
  EXPECT_EQ(run_with("# the ward\n[serve]\nlocal_role = \"none\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr(file_ + ":3: unknown key 'local_role' in [serve]; did you mean local-role?"));

  EXPECT_EQ(run_with("local-role = \"none\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr(file_ + ":1: unknown key 'local-role' before the first table"));

  EXPECT_EQ(run_with("[server]\nlocal-role = \"none\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr(file_ + ":1: unknown table [server]; did you mean serve?"));
}

TEST_F(ProgramTest, ListOverSeveralLines_HoldsNoKeys) {
  EXPECT_EQ(run_with("[serve]\nhost-name = [\"ward\",\n  \"floor = 3\"]\nlisten = \"nowhere\"\n", {"serve"}), cli::kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("cannot listen on 'nowhere'"));
}

TEST_F(ProgramTest, PipeFolderAndDeviceAsConfiguration_AreRefusedAtOnce) {
  const std::string pipe = (directory_.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& file : {pipe, directory_.path().string(), std::string("/dev/zero")}) {
    cli::Console console{.out = out_, .talk = talk_};
    EXPECT_EQ(run({"--config", file, "serve"}, console), cli::kUsage);
    EXPECT_THAT(talk_.str(), HasSubstr(file + " is no file that can be read"));
  }
}

TEST_F(ProgramTest, TableOfServe_DoesNotServeWhenAnotherCommandIsGiven) {
  EXPECT_EQ(run_with("[serve]\nlisten = \"nowhere\"\n", {"man"}), cli::kOk) << talk_.str();

  EXPECT_THAT(out_.str(), HasSubstr(".TH"));
}

}  // namespace
}  // namespace dts::gateway
