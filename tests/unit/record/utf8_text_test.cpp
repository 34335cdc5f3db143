// SPDX-License-Identifier: Apache-2.0
#include "record/utf8_text.h"

#include <gtest/gtest.h>

namespace dts::record {
namespace {

TEST(CleanText, GoodText_StaysAsItIs) {
  const std::string text = "a\t\n\r~ \u00B5 \u20AC \U0001F600 \uFFFD";
  EXPECT_EQ(clean_text(text), text);
}

TEST(CleanText, WhatXmlForbids_BecomesTheReplacement) {
  EXPECT_EQ(clean_text(std::string("\0a\x1F", 3)), "\uFFFDa\uFFFD");
  EXPECT_EQ(clean_text("\xEF\xBF\xBE"), "\uFFFD") << "U+FFFE";
  EXPECT_EQ(clean_text("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD") << "half a surrogate pair";
  EXPECT_EQ(clean_text("\xF4\x90\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD") << "beyond U+10FFFF";
}

TEST(CleanText, BytesThatAreNoUtf8_AreReplacedOneForOne) {
  EXPECT_EQ(clean_text("\xC0\x80"), "\uFFFD\uFFFD") << "an overlong zero";
  EXPECT_EQ(clean_text("a\xE2\x82"), "a\uFFFD\uFFFD") << "cut";
  EXPECT_EQ(clean_text("\xE2\x82z"), "\uFFFD\uFFFDz");
  EXPECT_EQ(clean_text("\x80\xFF"), "\uFFFD\uFFFD");
}

}  // namespace
}  // namespace dts::record
