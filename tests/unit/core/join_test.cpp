// SPDX-License-Identifier: Apache-2.0
#include "core/join.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/suggest.h"

namespace dts::core {
namespace {

TEST(Join, Items_AreSeparatedAlsoIfOneIsEmpty) {
  EXPECT_EQ(join(std::vector<std::string>{}), "");
  EXPECT_EQ(join(std::vector<std::string>{"a"}), "a");
  EXPECT_EQ(join(std::vector<std::string>{"a", "", "b"}, ","), "a,,b");
  EXPECT_EQ(join(std::vector<int>{1, 20}, " ", [](int number) { return std::to_string(number); }), "1 20");
}

TEST(KnownWordsHint, NamesASimilarWordOrAllWords) {
  const std::vector<std::string> known{"floor", "chair"};
  EXPECT_EQ(known_words_hint("flor", known), "did you mean 'floor'?");
  EXPECT_EQ(known_words_hint("attic", known), "known: floor, chair");
  EXPECT_EQ(known_words_hint("attic", std::vector<std::string>{}), "there are none");
}

}  // namespace
}  // namespace dts::core
