// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ctl/command_tree.h"
#include "unit/cli/command_checks.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;

struct Wrong {
  std::vector<std::string> words;
  std::string says;
};

TEST_F(RunTest, WrongUsage_ExitsWithTwoAndSaysWhatWasMeant) {
  const std::vector<Wrong> cases{{{}, "a command is missing"},
                                 {{"statsu"}, "did you mean status?"},
                                 {{"session", "strat", "--rig", "floor"}, "did you mean start?"},
                                 {{"rig"}, "one of: list, show"},
                                 {{"status", "--jsno"}, "did you mean --json?"},
                                 {{"watch", "--cuont", "5"}, "did you mean --count?"},
                                 {{"session", "start"}, "--rig is required"},
                                 {{"tare"}, "--rig is required"},
                                 {{"rig", "show"}, "RIG is required"},
                                 {{"mark"}, "TEXT is required"},
                                 {{"mark", ""}, "1 to 200 bytes"},
                                 {{"mark", std::string(201, 'x')}, "1 to 200 bytes"},
                                 {{"mark", "eyes", "closed"}, "quotes"},
                                 {{"status", "extra"}, "unexpected argument 'extra'"},
                                 {{"watch", "--count", "0"}, "'0' is not a whole number from 1"},
                                 {{"watch", "--count", "-1"}, "'-1' is not a whole number from 1"},
                                 {{"watch", "--count", "1.5"}, "'1.5' is not a whole number from 1"},
                                 {{"watch", "--count", "99999999999999999999"}, "not a whole number"},
                                 {{"status", "--timeout", "0"}, "from 0.03 to 86400"},
                                 {{"status", "--timeout", "nan"}, "from 0.03 to 86400"},
                                 {{"status", "--timeout", "1e9"}, "from 0.03 to 86400"},
                                 {{"session", "start", "--rig", "floor", "--duration", "-1"}, "from 0 to 604800"},
                                 {{"session", "start", "--rig", "floor", "--settle", "inf"}, "from 0 to 3600"},
                                 {{"completion", "fish"}, "bash,zsh"},
                                 {{"watch", "--json"}, "--jsonl"},
                                 {{"status", "--endpoint", "nonsense"}, "is not an address"},
                                 {{"session", "lsit"}, "did you mean list?"},
                                 {{"session", "list", "--limit", "0"}, "from 1 to 1000"},
                                 {{"session", "show"}, "ID is required"},
                                 {{"session", "verify"}, "ID|FILE is required"},
                                 {{"session", "export", "x.xdf"}, "--format is required"},
                                 {{"session", "trial"}, "ACTION is required"},
                                 {{"session", "abort", "--reason", std::string(201, 'x')}, "0 to 200 bytes"},
                                 {{"audit", "--limit", "-1"}, "from 1 to 1000"}};
  for (const Wrong& wrong : cases) {
    EXPECT_EQ(run_bare(wrong.words), cli::kUsage) << ::testing::PrintToString(wrong.words);
    EXPECT_THAT(talk(), HasSubstr(wrong.says)) << ::testing::PrintToString(wrong.words);
    const bool is_json = std::ranges::find(wrong.words, "--json") != wrong.words.end();
    EXPECT_EQ(out().empty(), !is_json) << ::testing::PrintToString(wrong.words);
  }
}

TEST_F(RunTest, EveryCommand_HasHelpWithExamplesBeforeOptions) {
  const auto tree = make_command_tree();

  for (const CLI::App* command : cli::commands_of(tree->line.app)) {
    std::vector<std::string> words = cli::shell_words(cli::full_name(*command));
    words.erase(words.begin());
    words.push_back("--help");
    EXPECT_EQ(run_bare(words), cli::kOk);
    const std::size_t example = out().find("\n  dtsctl ");
    ASSERT_NE(example, std::string::npos) << cli::full_name(*command);
    EXPECT_LT(example, out().find("\nUsage: ")) << cli::full_name(*command);
    EXPECT_LT(out().find("\nUsage: "), out().find("\nOptions:")) << cli::full_name(*command);
  }
}

TEST(Examples, OfEveryCommand_AreUnderstood) {
  const auto tree = make_command_tree();

  for (const CLI::App* command : cli::commands_of(tree->line.app)) {
    ASSERT_FALSE(cli::examples(*command).empty()) << cli::full_name(*command);
    for (const cli::Example& example : cli::examples(*command)) {
      std::vector<std::string> words = cli::shell_words(example.command);
      ASSERT_EQ(words.front(), "dtsctl");
      const auto fresh = make_command_tree();
      EXPECT_NO_THROW(fresh->line.app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1))) << example.command;
    }
  }
}

TEST(CommandTree, EveryCommandThatIsNoGroup_HasAHandler) {
  const auto tree = make_command_tree();

  for (const CLI::App* command : cli::commands_of(tree->line.app)) {
    EXPECT_EQ(tree->line.handlers.contains(command), cli::subcommands(*command).empty()) << cli::full_name(*command);
  }
}

TEST_F(RunTest, Version_IsPrinted) {
  EXPECT_EQ(run_bare({"--version"}), cli::kOk);

  EXPECT_EQ(out(), "dtsctl " + std::string(client::version()) + "\n");
}

}  // namespace
}  // namespace dts::ctl
