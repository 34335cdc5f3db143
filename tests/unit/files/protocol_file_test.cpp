// SPDX-License-Identifier: Apache-2.0
#include "files/protocol_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace dts::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kShipped = std::string(DTS_SOURCE_DIR) + "/config/protocols";

class ProtocolFiles : public testing::Test {
 protected:
  ProtocolFiles() {
    std::string pattern = testing::TempDir() + "dts-protocols-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~ProtocolFiles() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

std::string all(const Problems& problems) {
  std::string text;
  for (const Problem& problem : problems) text += to_string(problem) + "\n";
  return text;
}
std::string problems_of(const std::string& text) {
  Problems problems;
  (void)read_protocol_text(text, "p", problems);
  return all(problems);
}
std::vector<std::string> names(const std::vector<session::Protocol>& protocols) {
  std::vector<std::string> found;
  for (const session::Protocol& protocol : protocols) found.push_back(protocol.name);
  return found;
}
session::Protocol shipped(const std::string& name) {
  Problems problems;
  auto protocol = read_protocol(kShipped + "/" + name + ".toml", problems);
  EXPECT_EQ(all(problems), "");
  return protocol;
}

constexpr const char* kTrials = "name = \"x\"\n[trials]\n";
constexpr const char* kCondition = "[[trials.condition]]\nname = \"a\"\n";

TEST_F(ProtocolFiles, Shipped_AreAllGood) {
  Problems problems;
  EXPECT_THAT(names(read_protocols(kShipped, problems)),
              ElementsAre("free", "quiet-standing", "reaching-short", "reaching-task", "romberg"));
  EXPECT_EQ(all(problems), "");
}

TEST_F(ProtocolFiles, QuietStanding_IsTheOneOfTheThesis) {
  const auto protocol = shipped("quiet-standing");
  ASSERT_TRUE(protocol.trials.has_value());
  EXPECT_EQ(protocol.trials->settle_s, 5.0);
  EXPECT_EQ(protocol.trials->settle_s + protocol.trials->duration_s, 25.0);
  EXPECT_FALSE(protocol.trials->starts_by_itself);
  ASSERT_EQ(protocol.trials->conditions.size(), 4U);
  EXPECT_THAT(protocol.trials->conditions[1].labels, testing::UnorderedElementsAre(std::pair<std::string, std::string>("eyes", "closed"),
                                                                                   std::pair<std::string, std::string>("feet", "two"),
                                                                                   std::pair<std::string, std::string>("surface", "firm")));
  EXPECT_TRUE(session::check_fields(protocol, {}));
}

TEST_F(ProtocolFiles, ReachingTask_TakesTheVolunteersOfTheThesis) {
  const auto protocol = shipped("reaching-task");
  ASSERT_TRUE(protocol.trials.has_value());
  EXPECT_EQ(protocol.trials->trials_per_block, 15U);
  EXPECT_EQ(protocol.trials->order, session::TrialOrder::Randomised);
  ASSERT_EQ(protocol.trials->conditions.size(), 5U);
  EXPECT_EQ(protocol.trials->conditions[3].target_percent, 150.0);
  EXPECT_TRUE(protocol.trials->conditions[4].is_maximum_reach);
  const auto accepts = [&](const char* arm_cm, const char* reach_cm) {
    return session::check_fields(protocol, {{"sex", "female"},
                                            {"age_years", "26"},
                                            {"weight_kg", "67"},
                                            {"height_cm", "165"},
                                            {"side", "right"},
                                            {"arm_length_cm", arm_cm},
                                            {"max_reach_cm", reach_cm}})
        .has_value();
  };
  EXPECT_TRUE(accepts("65.5", "121"));  // H4
  EXPECT_TRUE(accepts("65", "120"));    // S3
  EXPECT_FALSE(accepts("68", "43"));    // S1 had targets of her own
}

TEST_F(ProtocolFiles, ExampleOfTheReadme_IsGood) {
  std::ifstream readme(kShipped + "/README.md");
  std::string line;
  std::string example;
  while (std::getline(readme, line)) {
    if (line.starts_with("    ") || (line.empty() && !example.empty())) example += line + "\n";
    if (line.starts_with("## All keys")) break;
  }
  Problems problems;
  const auto protocol = read_protocol_text(example, "README.md", problems);
  EXPECT_EQ(all(problems), "");
  EXPECT_EQ(protocol.name, "balance-clinic");
  ASSERT_TRUE(protocol.trials.has_value());
  EXPECT_EQ(protocol.trials->trials_per_block, 2U);
  EXPECT_EQ(protocol.trials->block_rest_s, 30.0);
}

TEST_F(ProtocolFiles, BuiltInFree_IsItsOwnDefinition) {
  Problems problems;
  EXPECT_EQ(read_protocol_text(session::free_protocol().definition, "free", problems), session::free_protocol());
  EXPECT_EQ(all(problems), "");
}

TEST_F(ProtocolFiles, Definition_IsTheTextOfTheFile) {
  const std::string text = "# a clinic's\nname = \"x\"  # one\nduration_s = 60\n";
  Problems problems;
  const auto protocol = read_protocol(write("x.toml", text), problems);
  EXPECT_EQ(all(problems), "");
  EXPECT_EQ(protocol.definition, text);
  EXPECT_EQ(protocol, read_protocol_text(protocol.definition, "recorded", problems));
  EXPECT_EQ(protocol.settle_s, 0.0);
  EXPECT_EQ(read_protocol_text("name = \"x\"\n", "p", problems).duration_s, 0.0) << "until it is stopped";
  EXPECT_EQ(read_protocol_text("name = \"x\"\nduration_s = 0.5\n", "p", problems).duration_s, 0.5);
  EXPECT_EQ(all(problems), "");
}

TEST_F(ProtocolFiles, NoFolderOrAFile_HasTheBuiltInOne) {
  Problems problems;
  EXPECT_THAT(names(read_protocols(folder_ / "none", problems)), ElementsAre("free"));
  EXPECT_EQ(all(problems), "");
  EXPECT_THAT(names(read_protocols(write("file", ""), problems)), ElementsAre("free"));
  EXPECT_THAT(all(problems), HasSubstr("cannot be read"));
}

TEST_F(ProtocolFiles, FreeOfAFile_ReplacesTheBuiltIn) {
  write("free.toml", "name = \"free\"\nduration_s = 30\n");
  Problems problems;
  const auto protocols = read_protocols(folder_, problems);
  ASSERT_THAT(names(protocols), ElementsAre("free"));
  EXPECT_EQ(protocols[0].duration_s, 30.0);
}

TEST_F(ProtocolFiles, SameNameTwice_NamesBothFiles) {
  write("a.toml", "name = \"x\"\n");
  write("b.toml", "name = \"x\"\n");
  write("c.txt", "this is none");
  Problems problems;
  EXPECT_THAT(names(read_protocols(folder_, problems)), ElementsAre("free", "x"));
  EXPECT_THAT(all(problems), testing::AllOf(HasSubstr("b.toml: name = \"x\" is taken by "), HasSubstr("a.toml")));
}

TEST_F(ProtocolFiles, OneBadAmongGood_IsLeftOutAndTold) {
  write("a.toml", "name = \"a\"\n");
  write("b.toml", "name = \"b\"\nduration_s = -1\n");
  Problems problems;
  EXPECT_THAT(names(read_protocols(folder_, problems)), ElementsAre("a", "free"));
  EXPECT_THAT(all(problems), HasSubstr("b.toml:2:"));
}

TEST_F(ProtocolFiles, NotAFileOrTooLarge_IsAProblemAndDoesNotBlock) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe.toml").c_str(), 0600), 0);
  std::filesystem::create_directory(folder_ / "folder.toml");
  write("large.toml", "name = \"x\"\n" + std::string(300'000, '#'));
  Problems problems;
  (void)read_protocols(folder_, problems);
  EXPECT_EQ(problems.size(), 3U);
  EXPECT_THAT(all(problems), HasSubstr("256 KiB"));
}

TEST_F(ProtocolFiles, UnknownKeys_AreToldWithASuggestionEverywhere) {
  EXPECT_THAT(problems_of("name = \"x\"\nduraton_s = 3\n"), HasSubstr("did you mean 'duration_s'?"));
  EXPECT_THAT(problems_of(std::string(kTrials) + "trial_per_block = 3\n" + kCondition), HasSubstr("did you mean 'trials_per_block'?"));
  EXPECT_THAT(problems_of(std::string(kTrials) + kCondition + "target_procent = 3\n"), HasSubstr("did you mean 'target_percent'?"));
  EXPECT_THAT(problems_of("name = \"x\"\n[trails]\n"), HasSubstr("did you mean 'trials'?"));
  EXPECT_THAT(problems_of("name = \"x\"\n[[field]]\nname = \"a\"\nminimum = 0\nmaximum = 1\nrequierd = true\n"),
              HasSubstr("did you mean 'required'?"));
}

struct Wrong {
  std::string text;
  const char* told;
};

TEST_F(ProtocolFiles, WrongValues_AreToldEachOnce) {
  const std::string field = "name = \"x\"\n[[field]]\nname = \"a\"\n";
  const std::string trials = kTrials;
  const std::vector<Wrong> cases{
      {"", "name is missing"},
      {"name = \"\"\n", "name must be 1 to 32"},
      {"name = \"Quiet Standing\"\n", "name must be 1 to 32"},
      {"name = \"" + std::string(33, 'x') + "\"\n", "name must be 1 to 32"},
      {"name = 3\n", "name must be a text"},
      {"name = \"x\"\nsentence = \"a\\nb\"\n", "sentence must be one line"},
      {"name = \"x\"\nsettle_s = 3601\n", "out of range"},
      {"name = \"x\"\nduration_s = nan\n", "out of range"},
      {field, "needs minimum and maximum, or choices"},
      {field + "minimum = 1\n", "maximum is missing"},
      {field + "maximum = 1\n", "minimum is missing"},
      {field + "minimum = 2\nmaximum = 1\n", "maximum is less"},
      {field + "minimum = 2\nmaximum = inf\n", "out of range"},
      {field + "choices = [\"one\"]\n", "choices must be 2 to 32"},
      {field + "choices = [\"one\", \"one\"]\n", "'one' stands twice"},
      {field + "choices = [\"one\", \"Two\"]\n", "a choice must be"},
      {field + "choices = [\"one\", \"two\"]\nminimum = 1\n", "unknown key 'minimum'"},
      {field + "choices = [\"o\", \"t\"]\n[[field]]\nname = \"a\"\nchoices = [\"o\", \"t\"]\n", "'a' stands twice"},
      {trials, "[trials] needs 1 to 32 conditions"},
      {trials + kCondition + kCondition, "'a' stands twice"},
      {trials + "order = \"random\"\n" + kCondition, "known: \"as-listed\", \"randomised\""},
      {trials + "blocks = 0\n" + kCondition, "out of range"},
      {trials + "trials_per_block = 201\n" + kCondition, "out of range"},
      {trials + "cue_delay_min_s = 2\ncue_delay_max_s = 1\n" + kCondition, "cue_delay_max_s is less"},
      {"name = \"x\"\nduration_s = 5\n[trials]\n" + std::string(kCondition), "write it below [trials]"},
      {trials + kCondition + "target_percent = 80\n", "arm_length_cm"},
      {trials + kCondition + "maximum_reach = true\n", "max_reach_cm"},
      {trials + kCondition + "labels = { phase = \"x\" }\n", "label 'phase' has a meaning already"},
      {trials + kCondition + "labels = { eyes = \"Wide Open\" }\n", "a label must be"},
      {trials + kCondition + "labels = { Eyes = \"open\" }\n", "a label's name must be"},
      {trials + kCondition + "labels = \"open\"\n", "must be a table"},
      {"name = x\n", "p:1:"},
      {"name = \"\xff\"\n", "p:1:"},
  };
  for (const Wrong& wrong : cases) {
    const std::string told = problems_of(wrong.text);
    EXPECT_THAT(told, HasSubstr(wrong.told)) << wrong.text;
    EXPECT_EQ(std::ranges::count(told, '\n'), 1) << wrong.text << told;
  }
}

TEST_F(ProtocolFiles, ManyThingsWrong_AreAllToldAtOnce) {
  EXPECT_THAT(problems_of("name = \"X\"\nsettle_s = -1\nbogus = 1\n[trials]\nblocks = 99\n"),
              testing::AllOf(HasSubstr("p:1:"), HasSubstr("p:2:"), HasSubstr("p:3:"), HasSubstr("p:5:"), HasSubstr("conditions")));
}

TEST_F(ProtocolFiles, PlannedTrials_OfATextThatPlansNoneOrDoesNotReadAreNone) {
  EXPECT_EQ(planned_trials(shipped("romberg").definition), 4U);
  EXPECT_EQ(planned_trials("name = \"x\"\n"), 0U);
  EXPECT_EQ(planned_trials("name = "), 0U);
  EXPECT_EQ(planned_trials(""), 0U);
}

}  // namespace
}  // namespace dts::files
