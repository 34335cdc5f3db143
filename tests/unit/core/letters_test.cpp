// SPDX-License-Identifier: Apache-2.0
#include "core/letters.h"

#include <gtest/gtest.h>

#include <string_view>

namespace dts::core {
namespace {

using namespace std::string_view_literals;

TEST(Letters, CapitalsOfManyScripts) {
  for (const char32_t capital : U"AZ\u00C4\u00DE\u0100\u0130\u0178\u0391\u0416\u0531\u10A0\u1E9E\uFF21\U00010400\U0001E921"sv) {
    EXPECT_TRUE(is_capital_letter(capital)) << static_cast<unsigned>(capital);
  }
  for (const char32_t other : U"az@[0\u00D7\u00DF\u00E4\u0101\u0131\u03B1\u0436\u05E9\u0639\u4E16\U00010428\U0010FFFF"sv) {
    EXPECT_FALSE(is_capital_letter(other)) << static_cast<unsigned>(other);
  }
}

TEST(Letters, EveryCapitalIsInTheTable) {
  unsigned capitals = 0;
  for (char32_t character = 0; character <= 0x10FFFF; ++character) capitals += is_capital_letter(character) ? 1 : 0;
  EXPECT_EQ(capitals, 1831U) << "of Unicode 14.0";
}

TEST(Letters, Spaces) {
  for (const char32_t space : U" \u00A0\u1680\u2000\u200A\u2028\u2029\u202F\u205F\u3000"sv) {
    EXPECT_TRUE(is_space(space)) << static_cast<unsigned>(space);
  }
  for (const char32_t other : U"a\t\n\u200B\u3001"sv) EXPECT_FALSE(is_space(other)) << static_cast<unsigned>(other);
}

}  // namespace
}  // namespace dts::core
