// SPDX-License-Identifier: Apache-2.0
#include "core/text_pattern.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace dts::core {
namespace {

bool is_match(const std::string& pattern, const std::string& text) {
  const auto compiled = TextPattern::compile(pattern);
  EXPECT_TRUE(compiled) << pattern;
  return compiled && compiled->matches(text);
}

std::string error_of(const std::string& pattern) {
  const auto compiled = TextPattern::compile(pattern);
  return compiled ? "" : compiled.error().what;
}

TEST(TextPattern, MatchesTheWholeText) {
  EXPECT_TRUE(is_match("abc", "abc"));
  for (const std::string text : {"", "ab", "abcd", "xabc", "ABC"}) EXPECT_FALSE(is_match("abc", text)) << text;
}

TEST(TextPattern, KnowsClassesGroupsAndCounts) {
  const std::vector<std::tuple<std::string, std::vector<std::string>, std::vector<std::string>>> cases{
      {"[a-c_-]+", {"a", "cab_-"}, {"", "d", "A"}},
      {"[^a-c]", {"d", "\xC3\xA4"}, {"a", "", "dd"}},
      {"a.c",
       {"abc",
        "a\xE4\xB8\x96"
        "c"},
       {"ac", "abbc"}},
      {"a\\.c", {"a.c"}, {"abc"}},
      {"(pre|post)-[0-9]{1,2}", {"pre-1", "post-12"}, {"pre-", "post-123", "pre"}},
      {"a?b*", {"", "a", "b", "abbb"}, {"aa", "ba"}},
      {"a{2}", {"aa"}, {"a", "aaa"}},
      {"a{2,}", {"aa", "aaaaa"}, {"a"}},
      {"a{0,2}b", {"b", "aab"}, {"aaab"}},
      {"(|x)y", {"y", "xy"}, {"xxy"}},
      {"(a*)*", {"", "aaa"}, {"b"}},
      {"\\p{Lu}[^\\p{Lu}\\p{Z}]+", {"Ab", "\u0416\u05e9"}, {"ab", "AB", "A ", "A\u00a0"}},
      {"[\\p{Z}x]+", {" x\u3000"}, {"p", "Z", "{", "}"}},
      {"[\xC3\xA0-\xC3\xBF]", {"\xC3\xA4"}, {"a", "\xC3"}},
  };
  for (const auto& [pattern, good, bad] : cases) {
    for (const std::string& text : good) EXPECT_TRUE(is_match(pattern, text)) << pattern << " : " << text;
    for (const std::string& text : bad) EXPECT_FALSE(is_match(pattern, text)) << pattern << " : " << text;
  }
}

TEST(TextPattern, RejectsTextsThatAreNotUtf8) { EXPECT_FALSE(is_match(".*", "a\xFF")); }

/// These pairs need exponential time in programs that try one way after the other. Here the test ends.
TEST(TextPattern, NeedsLinearTime) {
  const std::string many(10'000, 'a');
  EXPECT_FALSE(is_match("(a*)*b", many));
  EXPECT_FALSE(is_match("(a|a)*b", many));
  EXPECT_FALSE(is_match("(a?){100}a{100}b", many));
}

TEST(TextPattern, NamesThePlaceOfAMistake) {
  EXPECT_EQ(error_of("ab[c"), "the pattern has a mistake at character 5: ']' is missing");
  EXPECT_EQ(error_of("a)"), "the pattern has a mistake at character 2: ')' without '('");
  for (const std::string pattern :
       {"(a", "*a", "a**", "[b-a]", "[]", "a{2,1}", "a{", "a{999}", "\\", "\\d", "\\p", "\\p{L}", "[\\p{lu}]", "^a$", "a{,2}", "]"}) {
    EXPECT_NE(error_of(pattern), "") << pattern;
  }
}

TEST(TextPattern, BoundsItsSize) {
  EXPECT_EQ(error_of("((a{200}){200}){200}"), "the pattern is too large: use smaller numbers of repetitions");
  EXPECT_NE(error_of(""), "");
  EXPECT_NE(error_of(std::string(TextPattern::kLongestPattern + 1, 'a')), "");
  EXPECT_NE(error_of(std::string(100, '(') + std::string(100, ')')), "");
}

}  // namespace
}  // namespace dts::core
