// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ctl/command_tree.h"
#include "unit/cli/command_checks.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

TEST_F(RunTest, EveryCommand_HasHelpWithExamplesBeforeOptions) {
  RecordProperty("requirement", "UI-8");
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
  RecordProperty("requirement", "UI-8");
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
