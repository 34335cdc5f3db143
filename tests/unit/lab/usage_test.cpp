// SPDX-License-Identifier: Apache-2.0
#include "cli/documents.h"
#include "lab/command_tree.h"
#include "posturography/cop_series.h"
#include "posturography/measure.h"
#include "unit/cli/command_checks.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using ::testing::HasSubstr;

struct Wrong {
  std::vector<std::string> words;
  std::string says;
};

TEST_F(RunTest, WrongUsage_ExitsWithTwoAndSaysWhatWasMeant) {
  const std::vector<Wrong> cases{{{}, "a command is missing"},
                                 {{"plat"}, "did you mean plate?"},
                                 {{"plate"}, "one of: solve"},
                                 {{"plate", "solve"}, "CASE.toml is required"},
                                 {{"plate", "solve", "x.toml", "--method", "bem"}, "fdm,fem"},
                                 {{"plate", "solve", "x.toml", "--divisions", "1"}, "from 4 to 200"},
                                 {{"plate", "solve", "x.toml", "--divisions", "5000"}, "from 4 to 200"},
                                 {{"plate", "solve", "x.toml", "--divisions", "40.5"}, "from 4 to 200"},
                                 {{"plate", "solve", "x.toml", "--plot", "x.pdf"}, "ends in .svg or .png"},
                                 {{"thesis"}, "TABLE is required"},
                                 {{"thesis", "6.5"}, "one of 3.2, 3.3, 3.4, 3.5, 3.6, 4.1, 4.2, 5.2, 6.2, 6.3, 6.4, or all"},
                                 {{"sway"}, "FILE is required"},
                                 {{"sway", "x.csv", "--profile", "lp5"}, "asis,lp10"},
                                 {{"steadiness"}, "one of: train, classify"},
                                 {{"steadiness", "train", "x.csv", "--out", "m.json"}, "--label"}};
  for (const Wrong& wrong : cases) {
    EXPECT_EQ(run_with(wrong.words), cli::kUsage) << ::testing::PrintToString(wrong.words);
    EXPECT_THAT(talk(), HasSubstr(wrong.says)) << ::testing::PrintToString(wrong.words);
    EXPECT_EQ(out(), "") << ::testing::PrintToString(wrong.words);
  }
}

TEST_F(RunTest, EveryCommand_HasHelpWithExamplesBeforeOptions) {
  RecordProperty("requirement", "UI-8");
  const auto tree = make_command_tree();

  for (const CLI::App* command : cli::commands_of(tree->app)) {
    std::vector<std::string> words = cli::shell_words(cli::full_name(*command));
    words.erase(words.begin());
    words.push_back("--help");
    EXPECT_EQ(run_with(words), cli::kOk);
    const std::size_t example = out().find("\n  dtslab ");
    ASSERT_NE(example, std::string::npos) << cli::full_name(*command);
    EXPECT_LT(example, out().find("\nUsage: ")) << cli::full_name(*command);
  }
}

/// From the tables that the results are made with: a measure or a flag more is explained, too.
TEST_F(RunTest, HelpAndManualOfSway_NameEveryMeasureWithItsUnitAndEveryFlag) {
  for (const auto& words : {std::vector<std::string>{"sway", "--help"}, {"man"}}) {
    EXPECT_EQ(run_with(words), cli::kOk);
    std::string page = out();
    std::erase(page, '\\');  // of the manual page
    for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
      const auto& about = posturography::info(static_cast<posturography::Measure>(k));
      EXPECT_THAT(page, HasSubstr(std::string(about.symbol))) << words[0];
      EXPECT_THAT(page, HasSubstr(std::string(about.sentence) + " (" + (about.unit == "1" ? "no unit" : std::string(about.unit)) + ")"));
    }
    for (const auto flag : posturography::names_of(~0U)) EXPECT_THAT(page, HasSubstr(std::string(flag))) << words[0];
    EXPECT_THAT(page, HasSubstr(std::string(posturography::sentence_of(posturography::sway_flag::kCutAtGap))));
  }
}

TEST(Examples, OfEveryCommand_AreUnderstood) {
  RecordProperty("requirement", "UI-8");
  const auto tree = make_command_tree();

  for (const CLI::App* command : cli::commands_of(tree->app)) {
    ASSERT_FALSE(cli::examples(*command).empty()) << cli::full_name(*command);
    for (const cli::Example& example : cli::examples(*command)) {
      std::vector<std::string> words = cli::shell_words(example.command);
      ASSERT_EQ(words.front(), "dtslab");
      const auto fresh = make_command_tree();
      EXPECT_NO_THROW(fresh->app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1))) << example.command;
    }
  }
}

TEST_F(RunTest, Manual_NamesEveryCommandAndHasNoEmptyLine) {
  EXPECT_EQ(run_with({"man"}), cli::kOk);

  const auto tree = make_command_tree();
  for (const CLI::App* command : cli::commands_of(tree->app)) {
    if (!cli::subcommands(*command).empty()) continue;
    const std::string name = std::regex_replace(cli::full_name(*command), std::regex("-"), "\\-");
    EXPECT_THAT(out(), HasSubstr(".SS " + name));
  }
  EXPECT_THAT(out(), ::testing::Not(HasSubstr("\n\n")));
}

TEST_F(RunTest, Version_IsThatOfTheProject) {
  EXPECT_EQ(run_with({"--version"}), cli::kOk);

  EXPECT_EQ(out(), std::string("dtslab ") + DTS_VERSION + "\n");
}

}  // namespace
}  // namespace dts::lab
