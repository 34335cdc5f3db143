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
  for (const auto& [text, says] :
       {std::pair(std::string("# the ward\n[serve]\nlocal_role = 1\n"),
                  ":3: unknown key 'local_role' in [serve]; did you mean local-role?"),
        {"local-role = 1\n", ":1: unknown key 'local-role' before the first table"},
        {"[server]\nlocal-role = 1\n", ":1: unknown table [server]; did you mean serve?"},
        {"[serve]\n \"listem\" = 1\n", ":2: unknown key 'listem' in [serve]; did you mean listen?"},
        {"[serve]\n\t listen\n", ":2: 'listen' has no value"},
        {"[serve]\nhost-name = [\"ward\",\n  \"floor = 3\"]\nmetrix = 1\n", ":4: unknown key 'metrix' in [serve]; did you mean metrics?"},
        {std::string((1U << 20U) + 1, '\n'), " is larger than 1 MiB: that is no configuration"}}) {
    EXPECT_EQ(run_with(text, {"serve"}), cli::kUsage);
    EXPECT_THAT(talk_.str(), HasSubstr(file_ + says + "\n"));
  }
  EXPECT_EQ(run_with(std::string(1U << 20U, '\n'), {"man"}), cli::kOk);
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
    EXPECT_THAT(talk_.str(), HasSubstr(file + " is not a readable file"));
  }
}

TEST_F(ProgramTest, TableOfServe_DoesNotServeWhenAnotherCommandIsGiven) {
  EXPECT_EQ(run_with("[serve]\nlisten = \"nowhere\"\n", {"man"}), cli::kOk) << talk_.str();

  EXPECT_THAT(out_.str(), HasSubstr(".TH"));
}

}  // namespace
}  // namespace dts::gateway
