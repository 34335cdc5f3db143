// SPDX-License-Identifier: Apache-2.0
#include "cli/run.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <sstream>

#include "cli/documents.h"
#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/validators.h"
#include "support/committed_text.h"

namespace dts::cli {
namespace {

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

TEST_F(RunTest, WrongUsage_SaysWhatIsWrongAndWhatToTry) {
  struct Row {
    std::vector<std::string> words;
    std::string what;
    std::string hint;
  };
  const std::string boil = "kettle water boil --help";
  const std::vector<Row> rows{
      {{}, "a command is missing", "give one of: water, completion, man; kettle --help"},
      {{"water"}, "water: a command is missing", "give one of: boil, spill; kettle water --help"},
      {{"help"}, "unexpected command 'help'", "kettle --help"},
      {{"water", "help"}, "water: unexpected command 'help'", "kettle water --help"},
      {{"water", "boli"}, "water: unexpected command 'boli'", "did you mean boil? kettle water --help"},
      {{"water", "boil", "1", "--cusp", "2"}, "water boil: unexpected option '--cusp'", "did you mean --cups? " + boil},
      {{"water", "boil", "1", "--x=2"}, "water boil: unexpected option '--x=2'", boil},
      {{"water", "boil", "1", "2"}, "water boil: unexpected argument '2'", "put several words in quotes; " + boil},
      {{"water", "spill", "2"}, "water spill: unexpected argument '2'", "kettle water spill --help"},
      {{"water", "boil"}, "water boil: LITRES is required", boil},
      {{"water", "boil", "nan"}, "water boil: LITRES: 'nan' is not a number of litres from 0.1 to 2", boil},
      {{"water", "boil", "0.0999"}, "water boil: LITRES: '0.0999' is not a number of litres from 0.1 to 2", boil},
      {{"water", "boil", "2.001"}, "water boil: LITRES: '2.001' is not a number of litres from 0.1 to 2", boil},
      {{"water", "boil", "1l"}, "water boil: LITRES: '1l' is not a number of litres from 0.1 to 2", boil},
      {{"water", "boil", "1", "--cups", "0"}, "water boil: --cups: '0' is not a whole number from 1 to 8", boil},
      {{"water", "boil", "1", "--cups", "9"}, "water boil: --cups: '9' is not a whole number from 1 to 8", boil},
      {{"water", "boil", "1", "--cups", "1.5"}, "water boil: --cups: '1.5' is not a whole number from 1 to 8", boil}};
  for (Row row : rows) {
    EXPECT_EQ(run_with(row.words), kUsage);
    EXPECT_EQ(out_.str(), "");
    EXPECT_EQ(talk_.str(), "kettle: " + row.what + "\n  try: " + row.hint + "\n");
    row.words.emplace_back("--json");
    if (row.words.at(0) != "water" || row.words.size() < 3 || row.words.at(1) != "spill") continue;
    EXPECT_EQ(run_with(row.words), kUsage);
    EXPECT_EQ(out_.str(), document({{"error", {{"code", "invalid_argument"}, {"message", row.what}, {"hint", row.hint}}}}));
  }
  EXPECT_EQ(run_with({"water", "boil", "0.1", "--cups", "1"}), 42);
  EXPECT_EQ(run_with({"water", "boil", "2", "--cups", "8"}), 42);
}

TEST_F(RunTest, ErrorUnderJson_IsADocument) {
  EXPECT_EQ(run_with({"water", "spill", "--json"}), kFailed);
  EXPECT_EQ(out_.str(),
            "{\n  \"error\": {\n    \"code\": \"failed\",\n    \"message\": \"the floor is wet\",\n    \"hint\": \"mop\"\n  }\n}\n");
  EXPECT_EQ(talk_.str(), "kettle: the floor is wet\n  try: mop\n") << "people read it as ever";

  EXPECT_EQ(run_with({"water", "spill"}), kFailed);
  EXPECT_EQ(out_.str(), "");
}

/// What the program of this test prints about itself, as it is in kettle/.
TEST_F(RunTest, HelpAndDocuments_AreAsCommitted) {
  const Kettle kettle;
  const std::vector<std::pair<std::string, std::vector<std::string>>> helps{{"version", {"--version"}},
                                                                            {"help", {"--help"}},
                                                                            {"water", {"water", "--help"}},
                                                                            {"boil", {"water", "boil", "--help"}},
                                                                            {"spill", {"water", "spill", "--help"}}};
  std::vector<std::pair<std::string, std::string>> documents{
      {"man", manual_page(kettle.line)}, {"bash", bash_completion(kettle.line)}, {"zsh", zsh_completion(kettle.line)}};
  for (const auto& [name, words] : helps) {
    EXPECT_EQ(run_with(words), kOk);
    documents.emplace_back(name, out_.str());
  }
  for (const auto& [name, text] : documents) dts::test::expect_committed("unit/cli/kettle/" + name + ".txt", text);
}

TEST(ExitStatus, ErrorCodes_TheirOwnNumberOrFailed) {
  const std::vector<int> expected{1, 1, 2, 3, 4, 5, 6, 7, 1, 1, 1, 1, 1};
  for (std::size_t code = 0; code < expected.size(); ++code) EXPECT_EQ(exit_status(static_cast<int>(code)), expected[code]) << code;
}

TEST(Validators, CountAndText_AtTheirLimits) {
  const auto said = [](const CLI::Validator& validator, std::string text) { return validator(text); };
  EXPECT_EQ(said(count_from_one(), "1"), "");
  EXPECT_EQ(said(count_from_one(), "18446744073709551615"), "");
  for (const std::string wrong : {"0", "-1", "1.5", "18446744073709551616", "", "1 "}) {
    EXPECT_EQ(said(count_from_one(), wrong), "'" + wrong + "' is not a whole number of at least 1");
  }
  for (const std::string text : {"", "1", "22", "333", "4444"}) {
    EXPECT_EQ(said(text_of(1, 3), text), text.empty() || text.size() > 3 ? "the text must have 1 to 3 bytes" : "");
  }
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
