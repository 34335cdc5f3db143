// SPDX-License-Identifier: Apache-2.0
#include "files/toml_reader.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <sstream>

#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

class TomlText : public FilesTest {
 protected:
  [[nodiscard]] std::string problem_with(const std::string& text) const {
    Problems problems;
    const bool is_read = parse_toml_text(text, "file", problems).has_value();
    EXPECT_EQ(is_read, problems.empty());
    return text_of(problems);
  }
};

std::string dotted(std::size_t parts) {
  std::string key = "a";
  while (--parts > 0) key += ".a";
  return key;
}

TEST_F(TomlText, KeyOfTooManyParts_IsRefusedBeforeItEndsTheStack) {
  const std::string told = ": a key has more than 16 parts";
  EXPECT_EQ(problem_with("[" + dotted(16) + "]\n"), "");
  EXPECT_EQ(problem_with("# one\n[" + dotted(17) + "]\n"), "file:2:1" + told);
  const std::string deep = "\n" + dotted(200'000) + " = 1\n";
  for (const std::string before : {"", R"(b = "\"#")", R"(b = '\')", R"(b = "")", R"(b = """a"#"\""" """)", "b = \"\"\"a\"\"\"\"\"",
                                   "b = '''#''''", "'#'.c = 1", "# '", "b = [\"#\", '#']"}) {
    EXPECT_EQ(problem_with(before + deep), "file:2:1" + told) << before;
  }
  for (const std::string& line : {"b = {" + dotted(500'000) + " = 1}\n", "[[" + dotted(500'000) + "]]\n",
                                  R"("#"."a".'b'.)" + dotted(100'000) + " = 1\n", dotted(17) + " = 1\n"}) {
    EXPECT_EQ(problem_with(line), "file:1:1" + told) << line.substr(0, 20);
  }
}

TEST_F(TomlText, DotsElsewhere_AreNoParts) {
  std::string numbers = "b = [1.5";
  for (int count = 0; count < 100; ++count) numbers += ", 1.5";
  EXPECT_EQ(problem_with(numbers + "]\n"), "");
  EXPECT_EQ(problem_with("b = \"" + dotted(100) + "\" # " + dotted(100) + "\n"), "");
  EXPECT_EQ(problem_with("b = \"\"\"\n" + dotted(100) + " \\\" ' # \n\"\"\"\nc = '" + dotted(100) + "'\n"), "");
  EXPECT_EQ(problem_with("b = \"\"\"\n\"" + dotted(100) + "\"\"\"\"\"\n"), "");
  EXPECT_EQ(problem_with("b." + dotted(15) + " = 1\nc." + dotted(15) + " = { a." + dotted(15) + " = 1 }\n"), "");
}

/// Found by fuzzing.
TEST_F(TomlText, AQuotedLineBreak_BeginsNoLineOfItsOwn) {
  for (const std::string text : {"a = [[200, \tf\n_s,1]]\n", "a = in\nf\n", "a = \"b\nc\"\n", "a = f\x1b[31m\n"}) {
    const std::string problem = problem_with(text);
    EXPECT_NE(problem, "") << text;
    EXPECT_EQ(problem.find_first_of("\n\x1b"), std::string::npos) << problem;
  }
}

TEST_F(TomlText, WhatIsNoTomlFile_IsAProblem) {
  constexpr std::size_t kMost = std::size_t{4} << 20U;
  EXPECT_EQ(problem_with("#" + std::string(kMost - 1, ' ')), "");
  EXPECT_EQ(problem_with("#" + std::string(kMost, ' ')), "file: is larger than 4 MiB: this is not a file of dtsd");
  EXPECT_EQ(problem_with("a = 1\nb = x\n"), "file:2:5: Error while parsing value: could not determine value type");
  Problems problems;
  (void)parse_toml(folder_.string() + "/", problems);
  (void)parse_toml(write("huge", std::string(kMost + 1, '#')), problems);
  EXPECT_TRUE(parse_toml(write("large", std::string(kMost, '#')), problems));
  (void)parse_toml(path("none"), problems);
  EXPECT_EQ(text_of(problems),
            ": is a folder, not a file\n"
            "huge: is larger than 4 MiB: this is not a file of dtsd\n"
            "none: cannot be read: No such file or directory");
}

/// What a reader makes of the keys of a text: the values, then the problems.
class TomlValues : public FilesTest {
 protected:
  [[nodiscard]] std::string read(const std::string& text) const {
    Problems problems;
    const auto table = parse_toml_text(text, "file", problems);
    if (!table) return text_of(problems);
    TomlReader top(&*table, "", "file", problems);
    TomlReader reader = top.has("t") ? top.table("t") : top;
    std::ostringstream told;
    told << reader.number("number", 9.0, -1.5, 2.5) << ' ' << reader.integer("integer", 9, -1, 3) << ' ' << reader.boolean("boolean", true)
         << ' ' << reader.text("text", "none") << ' ' << reader.short_text("short").size() << ' '
         << reader.choice("choice", {"one", "three"});
    for (const std::int64_t value : reader.integers("integers", 0, 3)) told << " i" << value;
    for (const std::string& value : reader.texts("texts", {"x"})) told << ' ' << value;
    if (reader.has("list")) {
      for (const double value : read_list(reader, "list", reader.node("list"), 2, 3, 10.0)) told << " l" << value;
    }
    if (reader.has("pair")) (void)read_list(reader, "pair", reader.node("pair"), 2, 2, 1e30);
    for (TomlReader& entry : reader.tables("entry")) {
      entry.require("name");
      entry.require("size");
      told << " e" << entry.integer("name", 0, 0, 9);
      entry.finish();
    }
    reader.finish();
    if (problems.empty()) return told.str();
    return told.str() + " | " + text_of(problems);
  }
};

TEST_F(TomlValues, EachKind_ReadsOrReportsItsPlace) {
  for (const auto& [text, expected] : {
           std::pair<std::string, const char*>{"", "9 9 1 none 0 one x"},
           {"[t]", "9 9 1 none 0 one x"},
           {"t = 3", "9 9 1 none 0 one x | file:1:5: t must be a table: [t]"},
           {"[t]\nnumber = true", "9 9 1 none 0 one x | file:2:10: [t] number must be a number"},
           {"number = 2.5\ninteger = 3\nboolean = false\ntext = 'a'\nshort = 'b'\nchoice = 'three'", "2.5 3 0 a 1 three x"},
           {"number = -1.5\ninteger = -1\nboolean = true\ntext = ''\nshort = ''\nchoice = 'one'", "-1.5 -1 1  0 one x"},
           {"number = 2", "2 9 1 none 0 one x"},
           {"number = 2.6", "9 9 1 none 0 one x | file:1:10: number = 2.6 is out of range; allowed: -1.5 .. 2.5"},
           {"number = -1.6", "9 9 1 none 0 one x | file:1:10: number = -1.6 is out of range; allowed: -1.5 .. 2.5"},
           {"number = nan", "9 9 1 none 0 one x | file:1:10: number = nan is out of range; allowed: -1.5 .. 2.5"},
           {"number = inf", "9 9 1 none 0 one x | file:1:10: number = inf is out of range; allowed: -1.5 .. 2.5"},
           {"number = '2'", "9 9 1 none 0 one x | file:1:10: number must be a number"},
           {"number = true", "9 9 1 none 0 one x | file:1:10: number must be a number"},
           {"integer = 4", "9 9 1 none 0 one x | file:1:11: integer = 4 is out of range; allowed: -1 .. 3"},
           {"integer = -2", "9 9 1 none 0 one x | file:1:11: integer = -2 is out of range; allowed: -1 .. 3"},
           {"integer = 1.0", "9 9 1 none 0 one x | file:1:11: integer must be a whole number"},
           {"boolean = 1", "9 9 1 none 0 one x | file:1:11: boolean must be true or false"},
           {"text = 1", "9 9 1 none 0 one x | file:1:8: text must be a text in quotes"},
           {"short = '" + std::string(200, 's') + "'", "9 9 1 none 200 one x"},
           {"short = '" + std::string(201, 's') + "'", "9 9 1 none 0 one x | file:1:9: short is longer than 200 characters"},
           {"choice = 'thre'",
            "9 9 1 none 0 one x | file:1:10: choice = \"thre\" is not known; did you mean \"three\"?; known: \"one\", \"three\""},
           {"choice = 'zzzzzzzz'", "9 9 1 none 0 one x | file:1:10: choice = \"zzzzzzzz\" is not known; known: \"one\", \"three\""},
           {"choice = 1", "9 9 1 none 0 one x | file:1:10: choice must be a text in quotes"},
           {"integers = [0, 3, -1, 4, 1.5, 2]",
            "9 9 1 none 0 one i0 i3 i2 x | file:1:19: integers must hold whole numbers; allowed: 0 .. 3\n"
            "file:1:23: integers must hold whole numbers; allowed: 0 .. 3\n"
            "file:1:26: integers must hold whole numbers; allowed: 0 .. 3"},
           {"integers = 1", "9 9 1 none 0 one x | file:1:12: integers must be a list of whole numbers"},
           {"texts = ['a', 1, 'b']", "9 9 1 none 0 one a b | file:1:15: texts must hold texts in quotes"},
           {"texts = 'a'", "9 9 1 none 0 one x | file:1:9: texts must be a list of texts"},
           {"list = [10, -10.0]", "9 9 1 none 0 one x l10 l-10"},
           {"list = [1, 2, 3]", "9 9 1 none 0 one x l1 l2 l3"},
           {"list = [1, 2, 3, 4]", "9 9 1 none 0 one x | file:1:8: list must be a list of 2 to 3 numbers"},
           {"list = [1]", "9 9 1 none 0 one x | file:1:8: list must be a list of 2 to 3 numbers"},
           {"list = 1", "9 9 1 none 0 one x | file:1:8: list must be a list of 2 to 3 numbers"},
           {"list = [1, 10.1]", "9 9 1 none 0 one x | file:1:8: list: number 2 of the list is not a finite number of at most 10 in size"},
           {"list = [-10.1, 1]", "9 9 1 none 0 one x | file:1:8: list: number 1 of the list is not a finite number of at most 10 in size"},
           {"list = [nan, 1]", "9 9 1 none 0 one x | file:1:8: list: number 1 of the list is not a finite number of at most 10 in size"},
           {"list = ['1', 1]", "9 9 1 none 0 one x | file:1:8: list: number 1 of the list is not a finite number of at most 10 in size"},
           {"pair = [1]", "9 9 1 none 0 one x | file:1:8: pair must be a list of 2 numbers"},
           {"[[entry]]\nname = 1\nsize = 2\n[[entry]]\nname = 10\n",
            "9 9 1 none 0 one x e1 e0 | file:3:1: unknown key 'size' in [[entry]]\n"
            "file:4:1: [[entry]] size is missing\n"
            "file:5:8: [[entry]] name = 10 is out of range; allowed: 0 .. 9"},
           {"entry = 1", "9 9 1 none 0 one x | file:1:9: entry must be written as [[entry]]"},
           {"entry = [1]", "9 9 1 none 0 one x | file:1:9: entry must be written as [[entry]]"},
           {"[t]\ntexts = []\nnumbr = 1\nqqqqqqqqqqq = 2",
            "9 9 1 none 0 one | file:3:1: unknown key 'numbr' in [t]; did you mean 'number'?\n"
            "file:4:1: unknown key 'qqqqqqqqqqq' in [t]"},
           {"numbr = 1", "9 9 1 none 0 one x | file:1:1: unknown key 'numbr'; did you mean 'number'?"},
       }) {
    EXPECT_EQ(read(text), expected) << text;
  }
}

TEST_F(TomlValues, AbsentTable_IsReportedOnce) {
  Problems problems;
  const toml::table empty;
  TomlReader top(&empty, "", "file", problems);
  TomlReader absent = top.table("absent");
  for (const char* key : {"one", "two"}) absent.require(key);
  absent.report("one", "told");
  absent.finish();
  top.require("key");
  EXPECT_EQ(text_of(problems),
            "file: [absent] is missing\n"
            "file: told\n"
            "file: key is missing");
  EXPECT_THAT(absent.remaining_keys(), testing::IsEmpty());
}

TEST_F(TomlValues, RemainingKeys_AreThoseNotAskedForYet) {
  Problems problems;
  const auto table = parse_toml_text("a = 1\n  b = 2\nc = 3\n", "file", problems);
  TomlReader reader(&*table, "", "file", problems);
  (void)reader.integer("b", 0, 0, 9);
  EXPECT_THAT(reader.remaining_keys(), testing::ElementsAre("a", "c"));
  EXPECT_THAT(reader.remaining_keys(), testing::IsEmpty());
  reader.finish();
  EXPECT_EQ(text_of(problems), "");
  EXPECT_EQ(to_string(reader.position("b")), "file:2:7: ");
  EXPECT_EQ(to_string(reader.position("d")), "file: ");
}

}  // namespace
}  // namespace dts::files
