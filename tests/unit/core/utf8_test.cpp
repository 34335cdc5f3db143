// SPDX-License-Identifier: Apache-2.0
#include "core/utf8.h"

#include <gtest/gtest.h>

namespace dts::core {
namespace {

TEST(Utf8, ShortestFormsOnly) {
  EXPECT_TRUE(is_utf8("plain \xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80 \xf4\x8f\xbf\xbf"));
  EXPECT_FALSE(is_utf8("\xc0\xaf"));
  EXPECT_FALSE(is_utf8("\xe2\x82"));
  EXPECT_FALSE(is_utf8("\xf8\x88\x80\x80\x80"));
}

TEST(Utf8, Characters_AreCountedAndFound) {
  EXPECT_EQ(character_count(""), 0U);
  EXPECT_EQ(character_count("F\u00FC\u00DFe \U0001F9E6"), 6U);
  EXPECT_TRUE(starts_character('a') && starts_character('\xC3'));
  EXPECT_FALSE(starts_character('\xBC'));
}

TEST(Printable, ControlCharactersAndDirections_BecomeSpaces) {
  RecordProperty("requirement", "SEC-7");
  EXPECT_EQ(printable("a\x1b[2Jb\n\tc\x7f"), "a [2Jb  c ");
  EXPECT_EQ(printable("a\xC2\x9B"
                      "2Jb\xC2\x80"),
            "a 2Jb ")
      << "U+009B is a terminal's CSI, too";
  for (const char* direction :
       {"\u061C", "\u200E", "\u200F", "\u202A", "\u202B", "\u202C", "\u202D", "\u202E", "\u2066", "\u2067", "\u2068", "\u2069"}) {
    EXPECT_EQ(printable(std::string("a") + direction + "b"), "a b") << direction;
  }
}

TEST(Printable, BytesThatAreNoText_AreReplacedOneForOne) {
  const std::string bad(kReplacementCharacter);
  EXPECT_EQ(printable("a\x9B"
                      "2Jb"),
            "a" + bad + "2Jb")
      << "a raw CSI";
  EXPECT_EQ(printable("\xC2"), bad);
  EXPECT_EQ(printable("\xC0\x9B"), bad + bad) << "overlong";
  EXPECT_EQ(printable("\xED\xA0\x80"), bad + bad + bad) << "a surrogate";
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), bad + bad + bad + bad);
}

TEST(Printable, Text_StaysAsItIs) {
  for (const char* text : {"", "plain", "G\u00E4nse f\u00FC\u00DFe", "\u00A0", "\u5BA4", "\U0001F9E6", "\u202F"})
    EXPECT_EQ(printable(text), text);
}

}  // namespace
}  // namespace dts::core
