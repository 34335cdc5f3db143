// SPDX-License-Identifier: Apache-2.0
#include "core/suggest.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace dts::core {
namespace {

constexpr std::array<std::string_view, 4> kKnown = {"weight_n", "stance_width_mm", "seed", "noise_mv"};

TEST(Suggest, IsTheNearestKnownWord_OrNothing) {
  const struct {
    std::string word, suggested, why;
  } rows[]{
      {"sead", "seed", "one letter wrong"},
      {"weigt_n", "weight_n", "one letter missing"},
      {"seeed", "seed", "one letter too many"},
      {"sede", "seed", "neighbours swapped: one mistake"},
      {"Noise_mV", "noise_mv", "other case: equal"},
      {"stance_width", "stance_width_mm", "without its unit"},
      {"gravity", "", "far from everything"},
      {"soud", "", "two mistakes in four letters"},
      {"", "", "nothing"},
      {std::string(100'000, 's'), "", "very long"},
  };
  for (const auto& row : rows) EXPECT_EQ(suggest(row.word, kKnown), row.suggested) << row.why;
  EXPECT_EQ(suggest("seed", {}), "");
  EXPECT_EQ(suggest("y_m", std::array<std::string_view, 2>{"x_mm", "y_mm"}), "y_mm") << "of two that are near, the nearer";
}

}  // namespace
}  // namespace dts::core
