// SPDX-License-Identifier: Apache-2.0
#include "cli/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <sstream>

#include "cli/documents.h"
#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/validators.h"

namespace dts::cli {
namespace {

using ::testing::HasSubstr;

/// A program of one group with one command.
struct Kettle {
  CommandLine line{{.name = "kettle",
                    .version = "1.2.3",
                    .description = "Boils water",
                    .examples = "kettle water boil 2 | enough for two\n",
                    .takes_files = true}};
  double litres = 0.0;
  std::int64_t cups = 0;
  bool is_json = false;
  bool says_result = false;
  int spilt = kFailed;  ///< Status of `spill`.

  Kettle() {
    line.manual = {.summary = "boils water", .description = "Heats.", .exit_statuses = {0, 2}, .see_also = {{"tea", 7}}};
    CLI::App* group = add_group(line.app, "water", "About water", "kettle water boil 1 | one litre\n");
    CLI::App* boil = add_command(line, *group, "boil", "Boil it", "kettle water boil 1 --cups 4 | one litre\n", [this](Console& console) {
      console.out << litres << '\n';
      return 42;
    });
    CLI::App* spill = add_command(line, *group, "spill", "Spill it", "kettle water spill | wet\n", [this](Console& console) {
      if (says_result) console.out << "{}\n";
      print_error(console, "the floor is wet", "mop");
      return spilt;
    });
    explain(line, *spill, "PUDDLE | its area, m2\n");
    spill->add_flag("--json", is_json, "Print JSON");
    boil->add_option("LITRES", litres, "How much")->required()->option_text(" ")->check(number_between(0.1, 2.0, "litres"));
    boil->add_option("--cups", cups, "How many")->option_text("N")->check(whole_number_between(1, 8));
    add_common(line);
  }
};

class RunTest : public ::testing::Test {
 protected:
  int run_with(const std::vector<std::string>& words) {
    out_.str({});
    talk_.str({});
    return run(std::make_unique<Kettle>()->line, words, console_);
  }

  std::ostringstream out_;
  std::ostringstream talk_;
  Console console_{.out = out_, .talk = talk_};
};

TEST_F(RunTest, Command_RunsItsHandlerAndReturnsItsStatus) {
  EXPECT_EQ(run_with({"water", "boil", "1.5", "--cups", "8"}), 42);

  EXPECT_EQ(out_.str(), "1.5\n");
  EXPECT_EQ(talk_.str(), "");
}

TEST_F(RunTest, WrongUsage_NamesTheProgramTheCommandAndTheRange) {
  EXPECT_EQ(run_with({"water", "boil", "nan"}), kUsage);
  EXPECT_EQ(talk_.str(), "kettle: water boil: LITRES: 'nan' is not a number of litres from 0.1 to 2\n  try: kettle water boil --help\n");

  EXPECT_EQ(run_with({"water", "boil", "1", "--cups", "9"}), kUsage);
  EXPECT_THAT(talk_.str(), HasSubstr("'9' is not a whole number from 1 to 8"));

  EXPECT_EQ(run_with({"water", "boli"}), kUsage);
  EXPECT_EQ(talk_.str(), "kettle: water: unexpected command 'boli'\n  try: did you mean boil? kettle water --help\n");
}

TEST_F(RunTest, ErrorUnderJson_IsADocument) {
  EXPECT_EQ(run_with({"water", "spill", "--json"}), kFailed);
  EXPECT_EQ(Json::parse(out_.str()), (Json{{"error", {{"code", "failed"}, {"message", "the floor is wet"}, {"hint", "mop"}}}}));
  EXPECT_THAT(talk_.str(), HasSubstr("the floor is wet")) << "people read it as ever";

  EXPECT_EQ(run_with({"water", "boil", "--json"}), kUsage);
  EXPECT_EQ(Json::parse(out_.str()).at("error").at("code"), "invalid_argument");

  EXPECT_EQ(run_with({"water", "spill"}), kFailed);
  EXPECT_EQ(out_.str(), "");
}

TEST_F(RunTest, ErrorBehindAResultUnderJson_NoSecondDocument) {
  Kettle kettle;
  kettle.says_result = true;

  EXPECT_EQ(run(kettle.line, {"water", "spill", "--json"}, console_), kFailed);
  EXPECT_EQ(out_.str(), "{}\n");
}

TEST_F(RunTest, InterruptedUnderJson_NoDocument) {
  Kettle kettle;
  kettle.spilt = kInterrupted;

  EXPECT_EQ(run(kettle.line, {"water", "spill", "--json"}, console_), kInterrupted);
  EXPECT_EQ(out_.str(), "") << "what was printed before is not why it ended";
}

TEST_F(RunTest, OutputThatFailsUnderJson_StaysFailed) {
  out_.setstate(std::ios::badbit);

  EXPECT_EQ(run_with({"water", "spill", "--json"}), kFailed);
  EXPECT_FALSE(out_);
}

TEST_F(RunTest, HelpAsACommand_PointsToTheOption) {
  EXPECT_EQ(run_with({"help"}), kUsage);
  EXPECT_EQ(talk_.str(), "kettle: unexpected command 'help'\n  try: kettle --help\n");

  EXPECT_EQ(run_with({"water", "help"}), kUsage);
  EXPECT_EQ(talk_.str(), "kettle: water: unexpected command 'help'\n  try: kettle water --help\n");
}

TEST_F(RunTest, VersionAndHelp_SpeakOfTheProgram) {
  EXPECT_EQ(run_with({"--version"}), kOk);
  EXPECT_EQ(out_.str(), "kettle 1.2.3\n");

  EXPECT_EQ(run_with({"--help"}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("Help on a command: kettle COMMAND --help. The manual: kettle man"));

  EXPECT_EQ(run_with({"water", "boil", "--help"}), kOk);
  EXPECT_THAT(out_.str(), ::testing::Not(HasSubstr("Also:"))) << "there are no global options";
}

TEST_F(RunTest, WordsThatACommandPrints_AreExplainedInHelpAndManual) {
  EXPECT_EQ(run_with({"water", "spill", "--help"}), kOk);
  EXPECT_THAT(out_.str(), HasSubstr("\nOutput:\n  PUDDLE  its area, m2\n"));
  EXPECT_THAT(manual_page(Kettle().line), HasSubstr(".PP\nOutput:\n.TP\n.B PUDDLE\nits area, m2.\n"));

  EXPECT_EQ(run_with({"water", "boil", "--help"}), kOk);
  EXPECT_THAT(out_.str(), ::testing::Not(HasSubstr("Output")));
}

TEST_F(RunTest, Documents_SpeakOfTheProgram) {
  const Kettle kettle;

  EXPECT_THAT(bash_completion(kettle.line), HasSubstr("complete -o default -F _kettle kettle\n"));
  EXPECT_THAT(zsh_completion(kettle.line), HasSubstr("_describe -o kettle candidates || _files\n"));
  const std::string page = manual_page(kettle.line);
  EXPECT_THAT(page, ::testing::StartsWith(".TH KETTLE 1 \"\" \"kettle 1.2.3\""));
  EXPECT_THAT(page, HasSubstr(".SH EXIT STATUS\n.TP\n.B 0\nsuccess.\n.TP\n.B 2\nwrong usage or bad input.\n.SH SEE ALSO\n.BR tea (7)\n"));
  EXPECT_THAT(page, ::testing::Not(HasSubstr("ENVIRONMENT"))) << "it has none";
}

TEST(ExitStatus, ErrorCodes_TheirOwnNumberOrFailed) {
  EXPECT_EQ(exit_status(1), kFailed);
  EXPECT_EQ(exit_status(2), kUsage);
  EXPECT_EQ(exit_status(3), 3);
  EXPECT_EQ(exit_status(7), 7);
  EXPECT_EQ(exit_status(8), kFailed) << "time-out";
  EXPECT_EQ(exit_status(12), kFailed) << "internal";
}

TEST(SetNumber, UndefinedNumbers_AreAbsent) {
  Json json = Json::object();
  set_number(json, "a", 0.0);
  set_number(json, "b", std::numeric_limits<double>::quiet_NaN());
  set_number(json, "c", std::numeric_limits<double>::infinity());

  EXPECT_EQ(one_line(json), R"({"a":0.0})");
}

}  // namespace
}  // namespace dts::cli
