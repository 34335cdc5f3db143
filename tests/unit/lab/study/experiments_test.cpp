// SPDX-License-Identifier: Apache-2.0
#include "lab/study/experiments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lab/study/comparison.h"
#include "lab/study/study_plot.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;
using testing::HasSubstr;

Draw made(std::uint64_t seed, int correct) {
  Draw draw{.seed = seed};
  draw.nn1.healthy.resize(1);
  for (int k = 0; k < 15; ++k) draw.nn1.healthy[0].add(TrunkClass::Minor, k < correct ? TrunkClass::Minor : TrunkClass::Maximum);
  return draw;
}

TEST(Study, Networks_LearnFromOthersAndFromTheBodyModel) {
  const auto draws = run_study({.draws = 1, .has_healthy = false, .has_stroke = false, .has_recommended = false}, [](double) {});
  ASSERT_TRUE(draws) << draws.error().what;
  const Draw& draw = draws->front();
  EXPECT_EQ(draw.nn2_one_pace.trained_on, 45U);
  EXPECT_EQ(draw.nn2.trained_on, 180U);
  EXPECT_GT(draw.nn1.own_r, 0.98);
  EXPECT_GT(draw.nn2.own_r, 0.98);
  EXPECT_GE(sum(draw.nn1.teachers).correct(), 130U);
  EXPECT_EQ(sum(draw.nn2.teachers).total(), 135U);
  EXPECT_GE(sum(draw.nn2.teachers).correct(), 120U);  // 123 to 135 of 135 in draws of other people
  EXPECT_GT(sum(draw.nn2.teachers).correct(), sum(draw.nn2_one_pace.teachers).correct());
}

TEST(Study, Comparison_SaysTheSpreadBetweenDraws) {
  const auto figures = compare({made(1, 15), made(2, 9), made(3, 12)});
  const auto found = std::ranges::find(figures, "nn1_healthy_correct", &ComparedFigure::name);
  ASSERT_NE(found, figures.end());
  EXPECT_EQ(found->least(), 9.0);
  EXPECT_EQ(found->median(), 12.0);
  EXPECT_EQ(found->most(), 15.0);
  EXPECT_EQ(found->thesis, 424.0);  // by the rows of table 6.2, not the 416 under it
  const auto left_out = std::ranges::find(figures, "recommended_accuracy", &ComparedFigure::name);
  ASSERT_NE(left_out, figures.end());
  EXPECT_TRUE(std::isnan(left_out->median()));  // nobody was judged
}

TEST(Study, MiddleDraw_IsNeitherBestNorWorst) { EXPECT_EQ(middle_draw({made(1, 15), made(2, 9), made(3, 12)}).seed, 3U); }

TEST(Study, Picture_HoldsTheConfusionAndSaysThatItIsSynthetic) {
  const std::string script = study_script(made(4, 11));
  EXPECT_THAT(script, HasSubstr("$nn1 << END\n0 0 0\n1 0 0\n2 0 11\n3 0 0\n4 0 4\n"));
  EXPECT_THAT(script, HasSubstr("synthetic"));
  EXPECT_THAT(script, HasSubstr("-0.12 4.11 0.4 9.9\n"));
}

}  // namespace
}  // namespace dts::lab::study
