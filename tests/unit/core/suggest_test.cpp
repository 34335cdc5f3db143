// SPDX-License-Identifier: Apache-2.0
#include "core/suggest.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace dts::core {
namespace {

constexpr std::array<std::string_view, 4> kKnown = {"weight_n", "stance_width_mm", "seed", "noise_mv"};

TEST(Suggest, NothingKnown_SaysNothing) { EXPECT_EQ(suggest("seed", {}), ""); }

TEST(Suggest, EmptyWord_SaysNothing) { EXPECT_EQ(suggest("", kKnown), ""); }

TEST(Suggest, OneLetterWrong_FindsTheWord) { EXPECT_EQ(suggest("sead", kKnown), "seed"); }

TEST(Suggest, OneLetterMissing_FindsTheWord) { EXPECT_EQ(suggest("weigt_n", kKnown), "weight_n"); }

TEST(Suggest, OneLetterTooMany_FindsTheWord) { EXPECT_EQ(suggest("seeed", kKnown), "seed"); }

TEST(Suggest, NeighboursSwapped_CountsAsOneMistake) { EXPECT_EQ(suggest("sede", kKnown), "seed"); }

TEST(Suggest, OtherCase_CountsAsEqual) { EXPECT_EQ(suggest("Noise_mV", kKnown), "noise_mv"); }

TEST(Suggest, MissingUnit_FindsTheWord) { EXPECT_EQ(suggest("stance_width", kKnown), "stance_width_mm"); }

TEST(Suggest, FarFromEverything_SaysNothing) { EXPECT_EQ(suggest("gravity", kKnown), ""); }

TEST(Suggest, TwoMistakesInFourLetters_SaysNothing) { EXPECT_EQ(suggest("soud", kKnown), ""); }

TEST(Suggest, SeveralNear_TakesTheNearest) {
  constexpr std::array<std::string_view, 2> known = {"x_mm", "y_mm"};

  EXPECT_EQ(suggest("y_m", known), "y_mm");
}

TEST(Suggest, VeryLongWord_SaysNothing) { EXPECT_EQ(suggest(std::string(100'000, 's'), kKnown), ""); }

}  // namespace
}  // namespace dts::core
