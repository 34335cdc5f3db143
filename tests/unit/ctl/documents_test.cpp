// SPDX-License-Identifier: Apache-2.0
#include "cli/documents.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>

#include "ctl/command_tree.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;

/// What a shell command prints; its status goes to `status`.
std::string output_of(const std::string& command, int& status) {
  std::string text;
  FILE* pipe = ::popen(command.c_str(), "r");
  std::array<char, 4096> chunk{};
  for (std::size_t bytes = 0; (bytes = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0;) text.append(chunk.data(), bytes);
  status = ::pclose(pipe);
  return text;
}

class DocumentsTest : public RunTest {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const auto path = directory_.path() / name;
    std::ofstream(path) << text;
    return path.string();
  }
  const cli::CommandLine& line() { return tree_->line; }

  std::unique_ptr<CommandTree> tree_ = make_command_tree();
};

TEST_F(DocumentsTest, BashCompletion_IsValidBash) {
  const std::string file = write("completion.bash", cli::bash_completion(line()));

  int status = 1;
  const std::string complaints = output_of("bash -n " + file + " 2>&1", status);

  EXPECT_EQ(status, 0) << complaints;
}

TEST_F(DocumentsTest, BashCompletion_OffersWhatMayFollow) {
  const std::string file = write("completion.bash", cli::bash_completion(line()));
  const auto offered = [&](const std::string& words, int position) {
    int status = 1;
    return output_of("bash -c 'source " + file + "; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(position) +
                         "; _dtsctl; echo \"${COMPREPLY[*]}\"'",
                     status);
  };

  EXPECT_EQ(offered("dtsctl wa", 1), "watch\n");
  EXPECT_EQ(offered("dtsctl session st", 2), "start stop\n");
  EXPECT_EQ(offered("dtsctl --json session start --d", 4), "--duration --data\n");
  EXPECT_EQ(offered("dtsctl completion z", 2), "zsh\n");
}

TEST_F(DocumentsTest, ZshCompletion_IsValidZsh) {
  int status = 1;
  output_of("command -v zsh", status);
  if (status != 0) GTEST_SKIP() << "zsh is not installed";
  const std::string file = write("_dtsctl", cli::zsh_completion(line()));

  const std::string complaints = output_of("zsh -n " + file + " 2>&1", status);

  EXPECT_EQ(status, 0) << complaints;
}

TEST_F(DocumentsTest, ZshCompletion_QuotesDescriptions) {
  const std::string script = cli::zsh_completion(line());

  EXPECT_THAT(script, ::testing::StartsWith("#compdef dtsctl\n"));
  EXPECT_THAT(script, HasSubstr("'session:Start and stop sessions, and manage their recordings'"));
  EXPECT_THAT(script, HasSubstr("a rig'\\''s device"));
}

TEST_F(DocumentsTest, Manual_HasNoEmptySectionAndNamesEveryCommand) {
  const std::string page = cli::manual_page(line());

  std::istringstream lines(page);
  std::string previous;
  for (std::string line; std::getline(lines, line); previous = line) {
    const bool is_empty_section = previous.starts_with(".SH ") && line.starts_with(".SH ");
    const bool is_empty_command = previous.starts_with(".SS ") && line.starts_with(".S");
    EXPECT_FALSE(is_empty_section || is_empty_command) << previous;
    EXPECT_FALSE(line.empty()) << "after: " << previous;
  }
  for (const char* command : {"status", "rig show", "device test", "session start", "session export", "protocol show", "audit", "mark",
                              "tare", "watch", "doctor", "completion"}) {
    EXPECT_THAT(page, HasSubstr(std::string(".SS dtsctl ") + command));
  }
  for (const char* status : {"0", "1", "2", "3", "4", "5", "6", "7", "130"}) {
    EXPECT_THAT(page, HasSubstr(std::string("\n.TP\n.B ") + status + "\n")) << "an exit status";
  }
  for (const char* section : {"NAME", "SYNOPSIS", "EXAMPLES", "COMMANDS", "OPTIONS", "ENVIRONMENT", "EXIT STATUS", "FILES"}) {
    EXPECT_THAT(page, HasSubstr(std::string(".SH ") + section + "\n"));
  }
}

TEST_F(DocumentsTest, Examples_NameProtocolsThatAreShipped) {
  const std::string page = cli::manual_page(line());
  const std::regex named(R"((?:\\-\\-protocol|protocol show) ([a-z]+(?:\\?-[a-z]+)*))");
  std::size_t count = 0;
  for (std::sregex_iterator match(page.begin(), page.end(), named); match != std::sregex_iterator(); ++match, ++count) {
    const std::string name = std::regex_replace((*match)[1].str(), std::regex(R"(\\)"), "");
    EXPECT_TRUE(std::filesystem::exists(std::string(DTS_SOURCE_DIR) + "/config/protocols/" + name + ".toml")) << name;
  }
  EXPECT_GE(count, 2U);
}

TEST_F(DocumentsTest, Manual_IsCleanForGroff) {
  int status = 1;
  output_of("command -v groff", status);
  if (status != 0) GTEST_SKIP() << "groff is not installed";
  const std::string file = write("dtsctl.1", cli::manual_page(line()));

  const std::string complaints = output_of("groff -man -ww -z -Tutf8 " + file + " 2>&1", status);

  EXPECT_EQ(complaints, "");
}

TEST_F(DocumentsTest, Commands_PrintTheDocuments) {
  EXPECT_EQ(run_bare({"completion", "bash"}), cli::kOk);
  EXPECT_EQ(out(), cli::bash_completion(line()));
  EXPECT_EQ(run_bare({"completion", "zsh"}), cli::kOk);
  EXPECT_EQ(out(), cli::zsh_completion(line()));
  EXPECT_EQ(run_bare({"man"}), cli::kOk);
  EXPECT_EQ(out(), cli::manual_page(line()));
}

}  // namespace
}  // namespace dts::ctl
