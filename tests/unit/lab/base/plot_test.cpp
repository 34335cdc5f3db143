// SPDX-License-Identifier: Apache-2.0
#include "lab/base/plot.h"

#include <cmath>
#include <cstdlib>

#include "unit/lab/run_fixture.h"

namespace dts::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

PlateMap slope() {
  return {.title = "It's a slope",
          .quantity = "w (mm)",
          .from = {},
          .to = {{400.0}, {300.0}},
          .cells = 4,
          .value = [](physics::Point at) { return at.x.value > 350.0 ? std::nan("") : at.x.value; },
          .marks = {{.name = "load", .points = {{{100.0}, {50.0}}}}, {.name = "nothing", .points = {}}},
          .plate = {.a = {400.0}, .b = {300.0}}};
}

class PlotTest : public RunTest {};

TEST_F(PlotTest, MapScript_HasEveryPointAndNoNan) {
  const std::string script = map_script(slope());

  EXPECT_THAT(script, HasSubstr("100 150 100\n"));
  EXPECT_THAT(script, HasSubstr("400 0 nan\n"));
  EXPECT_THAT(script, HasSubstr("'It''s a slope'"));
  EXPECT_THAT(script, HasSubstr("title 'load'"));
  EXPECT_THAT(script, Not(HasSubstr("nothing"))) << "no points, no legend";
  EXPECT_THAT(script, Not(HasSubstr("rectangle")));
}

TEST_F(PlotTest, PatchLoads_AreRectangles) {
  PlateMap map = slope();
  map.patches = {{.centre = {{100.0}, {50.0}}, .width = {20.0}, .height = {30.0}}};

  EXPECT_THAT(map_script(map), HasSubstr("rectangle center 100,50 size 20,30 "));
  ASSERT_TRUE(draw_map(map, path("patch.svg"))) << "gnuplot understands it";
}

TEST_F(PlotTest, SvgAndPng_AreDrawnWhateverTheFileIsCalled) {
  const std::string odd = "a'b\"; system 'touch x' .svg";
  ASSERT_TRUE(draw_map(slope(), path(odd)));
  EXPECT_THAT(content(odd), HasSubstr("<svg"));

  ASSERT_TRUE(draw_map(slope(), path("map.png")));
  EXPECT_THAT(content("map.png"), StartsWith("\x89PNG"));

  ASSERT_TRUE(draw_map(slope(), path("map.SVG")));
  EXPECT_THAT(content("map.SVG"), HasSubstr("<svg"));

  ASSERT_TRUE(draw_curves({.title = "t", .x_label = "x", .y_label = "y", .curves = {{"c", {{0.0, 1.0}, {1.0, 2.0}}}}}, path("c.svg")));
  EXPECT_THAT(content("c.svg"), HasSubstr("<svg"));
}

TEST_F(PlotTest, OtherKinds_AreRefused) {
  for (const char* file : {"x.pdf", "x", "svg", "x.svg.gz"}) {
    const auto status = draw_map(slope(), path(file));
    ASSERT_FALSE(status) << file;
    EXPECT_EQ(status.error().code, core::ErrorCode::InvalidArgument);
  }
}

TEST_F(PlotTest, WrongScript_FailsWithGnuplotsWords) {
  const auto status = draw("plot nonsense\n", path("x.svg"));

  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("nonsense"));
  EXPECT_FALSE(std::filesystem::exists(path("x.svg")));
}

TEST_F(PlotTest, NoGnuplot_SaysHowToGetIt) {
  const std::string before = std::getenv("PATH");
  ::setenv("PATH", directory_.c_str(), 1);
  const auto status = draw("plot x\n", path("x.svg"));
  ::setenv("PATH", before.c_str(), 1);

  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, core::ErrorCode::Unsupported);
  EXPECT_THAT(status.error().hint, HasSubstr("apt-get install gnuplot-nox"));
}

TEST_F(PlotTest, NoFolder_FailsNamingTheFile) {
  const auto status = draw("plot x\n", path("none/x.svg"));

  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("none/x.svg"));
}

}  // namespace
}  // namespace dts::lab
