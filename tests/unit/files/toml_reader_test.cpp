// SPDX-License-Identifier: Apache-2.0
#include "files/toml_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace dts::files {
namespace {

std::string dotted(std::size_t parts) {
  std::string key = "a";
  while (--parts > 0) key += ".a";
  return key;
}

std::string problem_with(const std::string& text) {
  Problems problems;
  const bool is_read = parse_toml_text(text, "file", problems).has_value();
  EXPECT_EQ(is_read, problems.empty());
  return problems.empty() ? "" : to_string(problems[0]);
}

TEST(TomlText, KeyOfTooManyParts_IsRefusedBeforeItEndsTheStack) {
  EXPECT_EQ(problem_with("[" + dotted(16) + "]\n"), "");
  EXPECT_EQ(problem_with("# one\n[" + dotted(17) + "]\n"), "file:2:1: a key has more than 16 parts");
  EXPECT_EQ(problem_with(dotted(1'000'000) + " = 1\n"), "file:1:1: a key has more than 16 parts");
  EXPECT_EQ(problem_with("b = {" + dotted(500'000) + " = 1}\n"), "file:1:1: a key has more than 16 parts");
  EXPECT_EQ(problem_with("[[" + dotted(500'000) + "]]\n"), "file:1:1: a key has more than 16 parts");
}

TEST(TomlText, KeyOfTooManyPartsBehindStrings_IsFound) {
  const std::string deep = "\n" + dotted(200'000) + " = 1\n";
  for (const std::string before :
       {R"(b = "\"#")", R"(b = '\')", R"(b = "")", R"(b = """a"#"\""" """)", "b = \"\"\"a\"\"\"\"\"", "b = '''#''''", "'#'.c = 1"}) {
    EXPECT_NE(problem_with(before + deep).find("more than 16 parts"), std::string::npos) << before;
  }
  const std::string quoted = R"("#"."a".'b'.)";
  EXPECT_NE(problem_with(quoted + dotted(100'000) + " = 1\n").find("more than 16 parts"), std::string::npos);
}

TEST(TomlReader, WholeNumbers_OutsideTheirRangeOrOfAnotherKindAreProblems) {
  Problems problems;
  const auto table = parse_toml_text("cpus = [0, 3, -1, 4, 1.5, 2]\n", "file", problems);
  TomlReader reader(&*table, "", "file", problems);
  EXPECT_EQ(reader.integers("cpus", 0, 3), (std::vector<std::int64_t>{0, 3, 2}));
  ASSERT_EQ(problems.size(), 3U);
  constexpr std::array<std::size_t, 3> kColumns = {15, 19, 22};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(problems[i].column, kColumns[i]);
}

TEST(TomlText, DotsElsewhere_AreNoParts) {
  std::string numbers = "b = [1.5";
  for (int count = 0; count < 100; ++count) numbers += ", 1.5";
  EXPECT_EQ(problem_with(numbers + "]\n"), "");
  EXPECT_EQ(problem_with("b = \"" + dotted(100) + "\" # " + dotted(100) + "\n"), "");
  EXPECT_EQ(problem_with("b = \"\"\"\n" + dotted(100) + " \\\" ' # \n\"\"\"\nc = '" + dotted(100) + "'\n"), "");
}

}  // namespace
}  // namespace dts::files
