// SPDX-License-Identifier: Apache-2.0
#include "files/protocol_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

using testing::ElementsAre;

const std::string kShipped = kConfig / "protocols";

class ProtocolFiles : public FilesTest {
 protected:
  static void read(const std::string& text, Problems& problems) { (void)read_protocol_text(text, "p", problems); }
  [[nodiscard]] std::vector<std::string> names_in(const std::string& folder) {
    std::vector<std::string> found;
    for (const session::Protocol& protocol : read_protocols(folder, problems_)) found.push_back(protocol.name);
    return found;
  }
  session::Protocol shipped(const std::string& name) { return read_protocol(kShipped + "/" + name + ".toml", problems_); }
  [[nodiscard]] std::string told() const { return text_of(problems_); }

  Problems problems_;
};

TEST_F(ProtocolFiles, Shipped_AreAllGood) {
  EXPECT_THAT(names_in(kShipped), ElementsAre("free", "quiet-standing", "reaching-short", "reaching-task", "romberg", "romberg-feedback"));
  EXPECT_EQ(told(), "");
}

/// Returns what a shipped protocol has in English but not in German: "romberg: title".
std::vector<std::string> without_german(const session::Protocol& protocol) {
  std::vector<std::string> missing;
  const auto compare = [&](const std::string& where, const std::vector<session::Translation>& all, const session::Translation& english) {
    const session::Translation german = all.size() == 1 ? all.front() : session::Translation{};
    const auto check = [&](std::string_view key, bool is_missing) {
      if (is_missing) missing.push_back(where + ": " + std::string(key));
    };
    check("language", german.language != "de");
    check("title", german.title.empty() != english.title.empty());
    check("sentence", german.sentence.empty() != english.sentence.empty());
    check("label", german.label.empty() != english.label.empty());
    check("unit", german.unit.empty() != (english.unit != "years"));  // the only unit that is a word
    check("help", german.help.empty() != english.help.empty());
    check("choices", german.choices.size() != english.choices.size());
  };
  compare(protocol.name, protocol.translations, {.language = "en", .title = protocol.title, .sentence = protocol.sentence});
  for (const session::ProtocolField& field : protocol.fields) {
    compare(protocol.name + ", " + field.name, field.translations,
            {.language = "en", .label = field.label, .unit = field.unit, .help = field.help, .choices = field.choices});
  }
  if (!protocol.trials) return missing;
  for (const session::Condition& condition : protocol.trials->conditions) {
    compare(protocol.name + ", " + condition.name, condition.translations, {.language = "en", .title = condition.title});
  }
  return missing;
}

TEST_F(ProtocolFiles, Shipped_HaveEveryTextInGerman) {
  for (const session::Protocol& protocol : read_protocols(kShipped, problems_)) EXPECT_THAT(without_german(protocol), ElementsAre());
  EXPECT_THAT(without_german(session::free_protocol()), ElementsAre());
  Problems problems;
  EXPECT_EQ(read_protocol_text(session::free_protocol().definition, "free", problems).translations, session::free_protocol().translations);
  EXPECT_EQ(text_of(problems), "");
}

TEST_F(ProtocolFiles, German_OfAnotherNumberOfChoicesOrUnknownKeysIsReported) {
  read(
      "name = \"p\"\nde = { label = \"x\" }\n[[field]]\nname = \"side\"\nlabel = \"Side\"\nchoices = [\"left\", \"right\"]\n"
      "de = { choices = [\"links\"] }\n",
      problems_);
  EXPECT_THAT(told(), testing::AllOf(testing::HasSubstr("label"), testing::HasSubstr("choices must be as many as the field has")));
}

TEST_F(ProtocolFiles, QuietStanding_IsTheOneOfTheThesis) {
  RecordProperty("requirement", "SES-2");
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
  RecordProperty("requirement", "SES-2");
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

TEST_F(ProtocolFiles, RombergFeedback_HasOneConditionWithFeedback) {
  const auto protocol = shipped("romberg-feedback");
  ASSERT_TRUE(protocol.trials.has_value());
  std::string with_feedback;
  for (const session::Condition& condition : protocol.trials->conditions) {
    if (session::has_feedback(condition)) with_feedback += condition.name + ";";
  }
  EXPECT_EQ(with_feedback, "eyes-open-feedback;");
  EXPECT_THAT(protocol.trials->conditions[1].labels, testing::Contains(std::pair<std::string, std::string>("feedback", "cop")));
  const auto plain = shipped("romberg");
  EXPECT_EQ(protocol.trials->settle_s, plain.trials->settle_s);
  EXPECT_EQ(protocol.trials->duration_s, plain.trials->duration_s);
}

const std::string kFeedback = R"(name = "x"
rig_kind = "floor"
[trials]
[[trials.condition]]
name = "eyes-feedback"
feedback = true
labels = { eyes = "open" }
)";

TEST_F(ProtocolFiles, Feedback_KeepsItsResultsApart) {
  expect_problems(
      kFeedback,
      {
          {"feedback", "feedback = true", ""},
          {"feedback", "feedback = 1",
           "p:6:12: [[condition]] feedback must be true or false\n"
           "p:5:8: only a condition with feedback = true may have a name that ends with -feedback"},
          {"feedback", "feedback = false", "p:5:8: only a condition with feedback = true may have a name that ends with -feedback"},
          {"name = \"eyes", "name = \"eyes\"",
           "p:5:8: the name of a condition with feedback must end with -feedback, so that its results stay apart"},
          {"labels", "target_percent = 80",
           "p:6:12: a condition with a target has no feedback\n"
           "p:3:1: a target_percent needs a [[field]] named arm_length_cm, in centimetres"},
          {"labels", "labels = { eyes = \"closed\" }",
           "p:6:12: a condition with eyes closed has no feedback: the subject could not see it"},
          {"labels", "labels = { feedback = \"cop\" }", "p:7:23: label 'feedback' is reserved: write feedback = true in the condition"},
          {"rig_kind", "rig_kind = \"chair\"", "p:3:1: feedback needs a rig that measures the COP: rig_kind = \"floor\""},
      },
      read);
}

TEST_F(ProtocolFiles, ExampleOfTheReadme_IsGood) {
  std::ifstream readme(kShipped + "/README.md");
  std::string line;
  std::string example;
  while (std::getline(readme, line)) {
    if (line.starts_with("    ") || (line.empty() && !example.empty())) example += line + "\n";
    if (line.starts_with("## All keys")) break;
  }
  const auto protocol = read_protocol_text(example, "README.md", problems_);
  EXPECT_EQ(told(), "");
  EXPECT_EQ(protocol.name, "balance-clinic");
  ASSERT_TRUE(protocol.trials.has_value());
  EXPECT_EQ(protocol.trials->trials_per_block, 2U);
  EXPECT_EQ(protocol.trials->block_rest_s, 30.0);
}

const std::string kTrials = R"(name = "x"
sentence = "Stand still"
rig_kind = "chair"
[[field]]
name = "arm_length_cm"
label = "Arm length"
required = true
minimum = 30
maximum = 110
[[field]]
name = "max_reach_cm"
label = "Reach"
minimum = 1
maximum = 200
[[field]]
name = "side"
label = "Side"
choices = ["left", "right"]
[trials]
trials_per_block = 3
blocks = 2
order = "randomised"
starts_by_itself = true
cue_delay_min_s = 1.0
cue_delay_max_s = 2.0
settle_s = 5.0
duration_s = 20.0
rest_s = 3.0
block_rest_s = 60.0
[[trials.condition]]
name = "a"
labels = { eyes = "open", feet = "two" }
target_percent = 80
[[trials.condition]]
name = "b"
maximum_reach = true
)";
constexpr const char* kSession = "name = \"x\"\nsettle_s = 1\nduration_s = 2\n";

TEST_F(ProtocolFiles, EveryKey_ReachesItsField) {
  std::string every = kTrials;
  const auto insert = [&every](const std::string& line, const std::string& added) { every.insert(every.find(line) + line.size(), added); };
  insert("name = \"x\"\n", "title = \"Standing\"\n");
  insert("label = \"Arm length\"\n", "unit = \"cm\"\nhelp = \"From the acromion\"\n");
  insert("name = \"a\"\n", "title = \"Eyes open\"\n");
  EXPECT_EQ(read_protocol(write("x.toml", every), problems_),
            (session::Protocol{.name = "x",
                               .title = "Standing",
                               .sentence = "Stand still",
                               .rig_kind = "chair",
                               .fields = {{.name = "arm_length_cm",
                                           .label = "Arm length",
                                           .unit = "cm",
                                           .help = "From the acromion",
                                           .is_required = true,
                                           .minimum = 30,
                                           .maximum = 110},
                                          {.name = "max_reach_cm", .label = "Reach", .minimum = 1, .maximum = 200},
                                          {.name = "side", .label = "Side", .choices = {"left", "right"}}},
                               .trials = session::TrialPlan{.conditions = {{.name = "a",
                                                                            .title = "Eyes open",
                                                                            .labels = {{"eyes", "open"}, {"feet", "two"}},
                                                                            .target_percent = 80.0},
                                                                           {.name = "b", .title = "b", .is_maximum_reach = true}},
                                                            .trials_per_block = 3,
                                                            .blocks = 2,
                                                            .order = session::TrialOrder::Randomised,
                                                            .starts_by_itself = true,
                                                            .cue_delay_min_s = 1.0,
                                                            .cue_delay_max_s = 2.0,
                                                            .settle_s = 5.0,
                                                            .duration_s = 20.0,
                                                            .rest_s = 3.0,
                                                            .block_rest_s = 60.0},
                               .definition = every}));
  const auto text = [this](const std::string& definition) { return read_protocol_text(definition, "p", problems_); };
  EXPECT_EQ(text(kSession), (session::Protocol{.name = "x", .title = "x", .settle_s = 1.0, .duration_s = 2.0, .definition = kSession}));
  const std::string least = "name = \"x\"\n";
  EXPECT_EQ(text(least), (session::Protocol{.name = "x", .title = "x", .definition = least})) << "until it is stopped";
  const std::string few =
      least + "[trials]\ncue_delay_min_s = 1\nrest_s = 2\n[[trials.condition]]\nname = \"a\"\n[[trials.condition]]\nname = \"b\"\n";
  EXPECT_EQ(text(few).trials, (session::TrialPlan{.conditions = {{.name = "a", .title = "a"}, {.name = "b", .title = "b"}},
                                                  .trials_per_block = 2,
                                                  .cue_delay_min_s = 1.0,
                                                  .cue_delay_max_s = 1.0,
                                                  .rest_s = 2.0,
                                                  .block_rest_s = 2.0}));
  EXPECT_EQ(text(session::free_protocol().definition), session::free_protocol());
  EXPECT_EQ(told(), "");
}

TEST_F(ProtocolFiles, Folders_AreReadWhateverStandsInThem) {
  EXPECT_THAT(names_in(path("none")), ElementsAre("free"));
  write("a.toml", "name = \"x\"\n");
  write("c.txt", "this is none");
  write("free.toml", "name = \"free\"\nduration_s = 30\n");
  EXPECT_THAT(names_in(folder_), ElementsAre("free", "x"));
  EXPECT_EQ(read_protocols(folder_, problems_)[0].duration_s, 30.0) << "replaces the built-in one";
  EXPECT_EQ(told(), "");
  write("b.toml", "name = \"x\"\n");
  write("d.toml", "name = \"d\"\nduration_s = -1\n");
  ASSERT_EQ(::mkfifo((folder_ / "pipe.toml").c_str(), 0600), 0);
  std::filesystem::create_directory(folder_ / "folder.toml");
  write("large.toml", "name = \"y\"\n" + std::string((std::size_t{256} << 10U) - 11, '#'));
  write("larger.toml", "name = \"z\"\n" + std::string((std::size_t{256} << 10U) - 10, '#'));
  EXPECT_THAT(names_in(folder_), ElementsAre("free", "x", "y"));
  EXPECT_THAT(names_in(path("c.txt")), ElementsAre("free"));
  EXPECT_EQ(told(),
            "b.toml: name = \"x\" is taken by a.toml\n"
            "d.toml:2:14: duration_s = -1 is out of range; allowed: 0 .. 604800\n"
            "folder.toml: cannot be read\n"
            "larger.toml: is larger than 256 KiB: this is not a protocol file\n"
            "pipe.toml: cannot be read\n"
            "c.txt: cannot be read: Not a directory");
}

TEST_F(ProtocolFiles, Limits_AreReportedWithPlaceAndRange) {
  const auto repeated = [](int count, auto text) {
    std::string all;
    for (int k = 0; k < count; ++k) all += text(k);
    return all;
  };
  const auto words = [&repeated](int count) { return repeated(count, [](int k) { return "\"w" + std::to_string(k) + "\", "; }); };
  const auto labels = [&repeated](int count) {
    return repeated(count, [](int k) { return "l" + std::to_string(k) + " = \"a\", "; }) + "eyes = \"open\" }";
  };
  const auto fields = [&repeated](int count) {
    return repeated(count,
                    [](int k) { return "[[field]]\nname = \"f" + std::to_string(k) + "\"\nlabel = \"F\"\nminimum = 0\nmaximum = 0\n"; });
  };
  const auto conditions = [&repeated](int count) {
    return repeated(count, [](int k) { return "[[trials.condition]]\nname = \"c" + std::to_string(k) + "\"\n"; });
  };
  const std::string every_letter = "abcdefghijklmnopqrstuvwxyz-01234";
  expect_problems(
      kTrials,
      {
          {"name", "", "p:1:1: name is missing"},
          {"name", "name = \"\"", "p:1:8: name must be 1 to 32 of the characters a-z, 0-9 and -"},
          {"name", "name = \"Quiet Standing\"", "p:1:8: name must be 1 to 32 of the characters a-z, 0-9 and -"},
          {"name", "name = \"" + every_letter + "\"", ""},
          {"name", "name = \"" + every_letter + "5\"", "p:1:8: name must be 1 to 32 of the characters a-z, 0-9 and -"},
          {"name", "name = 3", "p:1:8: name must be a text in quotes"},
          {"name", "name = x", "p:1:8: Error while parsing value: could not determine value type"},
          {"name", "name = \"\xff\"", "p:1:8: Encountered invalid utf-8 sequence"},
          {"sentence", "sentence = \"a\\nb\"", "p:2:12: sentence must be one line of at most 200 bytes"},
          {"sentence", "sentence = \" ~\u00e4\"", ""},
          {"sentence", "sentence = \"" + std::string(200, 's') + "\"", ""},
          {"sentence", "sentence = \"" + std::string(201, 's') + "\"", "p:2:12: sentence must be one line of at most 200 bytes"},
          {"sentence", "title = \"" + std::string(65, 's') + "\"", "p:2:9: title must be one line of at most 64 bytes"},
          {"label", "", "p:4:1: [[field]] label is missing"},
          {"label",
           "label = \"" + std::string(64, 's') + "\"\nunit = \"" + std::string(16, 's') + "\"\nhelp = \"" + std::string(200, 's') + "\"",
           ""},
          {"label", "label = \"" + std::string(65, 's') + "\"", "p:6:9: label must be one line of at most 64 bytes"},
          {"label", "label = \"L\"\nunit = \"" + std::string(17, 's') + "\"", "p:7:8: unit must be one line of at most 16 bytes"},
          {"label", "label = \"L\"\nhelp = \"a\\tb\"", "p:7:8: help must be one line of at most 200 bytes"},
          {"label", "sentence = \"L\"", "p:6:12: 'sentence' of a field is now 'label', a short name; 'unit' and 'help' are separate"},
          {"rig_kind", "rig_kind = \"bed\"", "p:3:12: rig_kind = \"bed\" is not known; known: \"floor\", \"chair\""},
          {"rig_kind", "rig_kin = \"floor\"", "p:3:1: unknown key 'rig_kin'"},
          {"rig_kind", "settle_s = 1", "p:3:12: settle_s is set for each trial in this protocol: write it below [trials]"},
          {"rig_kind", "duration_s = 1", "p:3:14: duration_s is set for each trial in this protocol: write it below [trials]"},
          {"[[field]]", fields(29) + "[[field]]", ""},
          {"[[field]]", fields(30) + "[[field]]", "p:4:1: more than 32 fields"},
          {"name = \"arm", "name = \"max_reach_cm\"",
           "p:11:8: 'max_reach_cm' is listed twice\n"
           "p:19:1: a target_percent needs a [[field]] named arm_length_cm, in centimetres"},
          {"name = \"arm", "name = \"arm-length\"",
           "p:5:8: name must be 1 to 32 of the characters a-z, 0-9 and _\n"
           "p:19:1: a target_percent needs a [[field]] named arm_length_cm, in centimetres"},
          {"name = \"max", "name = \"reach\"", "p:19:1: a target at maximum_reach needs a [[field]] named max_reach_cm, in centimetres"},
          {"name = \"max", "name = \"max_reach_cm\"\nchoices = [\"left\", \"right\"]",
           "p:15:1: unknown key 'maximum' in [[field]]\n"
           "p:14:1: unknown key 'minimum' in [[field]]\n"
           "p:20:1: a target at maximum_reach needs a [[field]] named max_reach_cm, in centimetres"},
          {"required", "required = 1", "p:7:12: [[field]] required must be true or false"},
          {"required", "requierd = true", "p:7:1: unknown key 'requierd' in [[field]]; did you mean 'required'?"},
          {"minimum", "", "p:4:1: [[field]] minimum is missing"},
          {"maximum", "", "p:4:1: [[field]] maximum is missing"},
          {"minimum", "minimum = 110", ""},
          {"minimum", "minimum = 110.1", "p:9:11: maximum is less than minimum"},
          {"choices", "", "p:15:1: [[field]] needs minimum and maximum, or choices"},
          {"choices", "choices = [\"one\"]", "p:18:11: choices must be 2 to 32 words"},
          {"choices", "choices = [" + words(32) + "]", ""},
          {"choices", "choices = [" + words(33) + "]", "p:18:11: choices must be 2 to 32 words"},
          {"choices", "choices = [\"one\", \"one\"]", "p:18:11: 'one' is listed twice"},
          {"choices", "choices = [\"one\", \"Two\"]", "p:18:11: a choice must be 1 to 32 of the characters a-z, 0-9 and -"},
          {"choices", "choices = [\"one\", \"two\"]\nminimum = 1", "p:19:1: unknown key 'minimum' in [[field]]"},
          {"[trials]", "[trails]", "p:19:2: unknown key 'trails'; did you mean 'trials'?"},
          {"trials_per_block", "trials_per_block = 201\ntrial_per_block = 3",
           "p:20:20: [trials] trials_per_block = 201 is out of range; allowed: 1 .. 200\n"
           "p:21:1: unknown key 'trial_per_block' in [trials]; did you mean 'trials_per_block'?"},
          {"order", "order = \"random\"", "p:22:9: [trials] order = \"random\" is not known; known: \"as-listed\", \"randomised\""},
          {"order", "order = \"as-listed\"", ""},
          {"starts_by_itself", "starts_by_itself = 1", "p:23:20: [trials] starts_by_itself must be true or false"},
          {"cue_delay_min_s", "cue_delay_min_s = 2.0", ""},
          {"cue_delay_min_s", "cue_delay_min_s = 2.1", "p:25:19: cue_delay_max_s is less than cue_delay_min_s"},
          {"duration_s", "duration_s = nan", "p:27:14: [trials] duration_s = nan is out of range; allowed: 0 .. 3600"},
          {"[[trials.condition]]", conditions(30) + "[[trials.condition]]", ""},
          {"[[trials.condition]]", conditions(31) + "[[trials.condition]]",
           "p:19:1: [trials] needs 1 to 32 conditions: [[trials.condition]]"},
          {"name = \"a\"", "name = \"b\"", "p:35:8: 'b' is listed twice"},
          {"labels", "labels = { phase = \"x\" }", "p:32:20: label 'phase' is reserved"},
          {"labels", "labels = { eyes = \"Wide Open\" }", "p:32:19: a label must be 1 to 32 of the characters a-z, 0-9 and -"},
          {"labels", "labels = { Eyes = \"open\" }", "p:32:19: a label's name must be 1 to 32 of the characters a-z, 0-9 and _"},
          {"labels", "labels = { " + labels(7), ""},
          {"labels", "labels = { " + labels(8), "p:32:10: more than 8 labels"},
          {"labels", "title = \"" + std::string(65, 's') + "\"", "p:32:9: title must be one line of at most 64 bytes"},
          {"labels", "labels = \"open\"", "p:32:10: [[condition]] labels must be a table: [labels]"},
          {"target_percent", "target_percent = 301\ntarget_procent = 3",
           "p:33:18: [[condition]] target_percent = 301 is out of range; allowed: 1 .. 300\n"
           "p:34:1: unknown key 'target_procent' in [[condition]]; did you mean 'target_percent'?"},
          {"target_percent", "target_percent = 80\nmaximum_reach = true",
           "p:34:17: a target has maximum_reach or target_percent, not both"},
      },
      read);
  expect_ranges(kTrials,
                {
                    {"minimum", "[[field]]", "-1000000", "1000000", "-1100000", "1100000"},
                    {"maximum", "[[field]]", "-1000000", "1000000", "-1100000", "1100000"},
                    {"trials_per_block", "[trials]", "1", "200", "0", "201"},
                    {"blocks", "[trials]", "1", "50", "0", "51"},
                    {"cue_delay_min_s", "[trials]", "0", "3600", "-0.1", "3960"},
                    {"cue_delay_max_s", "[trials]", "0", "3600", "-1", "3601"},
                    {"settle_s", "[trials]", "0", "3600", "-1", "3601"},
                    {"rest_s", "[trials]", "0", "3600", "-0.1", "3960"},
                    {"block_rest_s", "[trials]", "0", "3600", "-1", "3601"},
                    {"target_percent", "[[condition]]", "1", "300", "0.9", "330"},
                },
                read);
  expect_problems(kSession,
                  {{"duration_s", "[trials]",
                    "p:3:1: [trials] needs 1 to 32 conditions: [[trials.condition]]\n"
                    "p:2:12: settle_s is set for each trial in this protocol: write it below [trials]"}},
                  read);
  expect_ranges(kSession,
                {
                    {"settle_s", "", "0", "3600", "-0.1", "3601"},
                    {"duration_s", "", "0", "604800", "-0.1", "604801"},
                },
                read);
}

TEST_F(ProtocolFiles, PlannedTrials_OfARecordingByDtsd01AreRead) {
  const std::string field_of_0_1 = "name = \"x\"\n[[field]]\nname = \"age_years\"\nsentence = \"Age\"\nminimum = 3\nmaximum = 120\n";
  EXPECT_EQ(planned_trials(field_of_0_1 + "[trials]\nblocks = 3\n[[trials.condition]]\nname = \"a\"\n"), 3U);
}

TEST_F(ProtocolFiles, PlannedTrials_OfATextThatPlansNoneOrDoesNotReadAreNone) {
  EXPECT_EQ(planned_trials(shipped("romberg").definition), 4U);
  EXPECT_EQ(planned_trials(kTrials), 6U);
  for (const std::string text : {"name = \"x\"\n", "name = ", ""}) EXPECT_EQ(planned_trials(text), 0U);
}

}  // namespace
}  // namespace dts::files
