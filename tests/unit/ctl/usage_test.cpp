// SPDX-License-Identifier: Apache-2.0
#include "ctl/command_tree.h"
#include "ctl/suggestion.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;

/// All commands below `command`, and itself.
void collect(const CLI::App& command, std::vector<const CLI::App*>& found) {
  found.push_back(&command);
  for (const CLI::App* subcommand : subcommands(command)) collect(*subcommand, found);
}

/// The words of an example as a shell would give them; what follows ">" or "|" is not ours.
std::vector<std::string> shell_words(const std::string& line) {
  std::vector<std::string> words;
  bool is_quoted = false;
  bool is_open = false;
  for (const char letter : line + " ") {
    if (letter == '"') {
      is_quoted = !is_quoted;
    } else if (letter == ' ' && !is_quoted) {
      is_open = false;
    } else {
      if (!is_open) words.emplace_back();
      is_open = true;
      words.back() += letter;
    }
  }
  const auto redirection = std::ranges::find_if(words, [](const std::string& word) { return word == ">" || word == "|"; });
  words.erase(redirection, words.end());
  return words;
}

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
                                 {{"session", "list"}, "unexpected command 'list'"}};
  for (const Wrong& wrong : cases) {
    EXPECT_EQ(run_bare(wrong.words), kUsage) << ::testing::PrintToString(wrong.words);
    EXPECT_THAT(talk(), HasSubstr(wrong.says)) << ::testing::PrintToString(wrong.words);
    EXPECT_EQ(out(), "") << ::testing::PrintToString(wrong.words);
  }
}

TEST_F(RunTest, EveryCommand_HasHelpWithExamplesBeforeOptions) {
  const auto tree = make_command_tree();
  std::vector<const CLI::App*> commands;
  collect(tree->app, commands);

  for (const CLI::App* command : commands) {
    std::vector<std::string> words = shell_words(full_name(*command));
    words.erase(words.begin());
    words.push_back("--help");
    EXPECT_EQ(run_bare(words), kOk);
    const std::size_t example = out().find("\n  dtsctl ");
    ASSERT_NE(example, std::string::npos) << full_name(*command);
    EXPECT_LT(example, out().find("\nUsage: ")) << full_name(*command);
    EXPECT_LT(out().find("\nUsage: "), out().find("\nOptions:")) << full_name(*command);
  }
}

TEST(Examples, OfEveryCommand_AreUnderstood) {
  const auto tree = make_command_tree();
  std::vector<const CLI::App*> commands;
  collect(tree->app, commands);

  for (const CLI::App* command : commands) {
    ASSERT_FALSE(examples(*command).empty()) << full_name(*command);
    for (const Example& example : examples(*command)) {
      std::vector<std::string> words = shell_words(example.command);
      ASSERT_EQ(words.front(), "dtsctl");
      const auto fresh = make_command_tree();
      EXPECT_NO_THROW(fresh->app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1))) << example.command;
    }
  }
}

TEST(CommandTree, EveryCommandThatIsNoGroup_HasAHandler) {
  const auto tree = make_command_tree();
  std::vector<const CLI::App*> commands;
  collect(tree->app, commands);

  for (const CLI::App* command : commands) {
    const bool is_handled = std::ranges::any_of(tree->handlers, [&](const auto& entry) { return entry.first == command; });
    EXPECT_EQ(is_handled, subcommands(*command).empty()) << full_name(*command);
  }
}

TEST_F(RunTest, Version_IsPrinted) {
  EXPECT_EQ(run_bare({"--version"}), kOk);

  EXPECT_EQ(out(), "dtsctl " + std::string(client::version()) + "\n");
}

TEST(Nearest, Word_IsFoundOnlyWhenNear) {
  const std::vector<std::string> words{"status", "session", "watch"};

  EXPECT_EQ(nearest("statsu", words), "status");
  EXPECT_EQ(nearest("wach", words), "watch");
  EXPECT_EQ(nearest("watchdog", words), "");
  EXPECT_EQ(nearest("x", words), "");
  EXPECT_EQ(nearest("", words), "");
  EXPECT_EQ(nearest("status", {}), "");
  EXPECT_EQ(nearest(std::string(100'000, 's'), words), "");
}

}  // namespace
}  // namespace dts::ctl
