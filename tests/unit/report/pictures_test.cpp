// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "report/outline.h"
#include "report/page_parts.h"
#include "report/spectrum_picture.h"
#include "report/stabilogram.h"
#include "report/sway_series.h"

namespace dts::report {
namespace {

using posturography::CopSeries;
using posturography::Prepared;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A circle stretched to semi-axes of `major` along `angle_deg` and `minor` across it: its covariance is known.
Prepared stretched_circle(double major, double minor, double angle_deg, std::size_t samples = 3600) {
  Prepared prepared{.rate_hz = 100.0};
  const double angle = angle_deg * std::numbers::pi / 180.0;
  for (std::size_t index = 0; index < samples; ++index) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(index) / static_cast<double>(samples);
    const double along = major * std::cos(phase);
    const double across = minor * std::sin(phase);
    prepared.ml_mm.push_back(along * std::cos(angle) - across * std::sin(angle));
    prepared.ap_mm.push_back(along * std::sin(angle) + across * std::cos(angle));
  }
  return prepared;
}

std::string drawn(const std::function<void(Canvas&)>& draw) {
  pugi::xml_document document;
  Canvas canvas = new_picture(document, 92.5, 80.0, "test");
  draw(canvas);
  return text_of(document, true);
}

pugi::xml_document parsed(const std::string& text) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(text.c_str())) << text.substr(0, 400);
  return document;
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

// Of a stretched circle the SDs are major/sqrt(2) and minor/sqrt(2); at N = 3600 the factor is 5.99967 (sheet 3.1: 2 (N^2-1)/(N (N-2)) F).
TEST(Stabilogram, Ellipse_HasTheSemiAxesOfTheCovariance) {
  const auto ellipse = ellipse_outline(stretched_circle(20.0, 5.0, 30.0));

  ASSERT_TRUE(ellipse.has_value());
  const double n = 3600.0;
  const double factor = (n * n - 1.0) / n * (std::pow(0.05, -2.0 / (n - 2.0)) - 1.0);
  const double sample = n / (n - 1.0);
  EXPECT_NEAR(ellipse->semi_major_mm, 20.0 * std::sqrt(factor * sample / 2.0), 1e-9);
  EXPECT_NEAR(ellipse->semi_minor_mm, 5.0 * std::sqrt(factor * sample / 2.0), 1e-9);
  EXPECT_NEAR(ellipse->angle_deg, 30.0, 1e-9);
  EXPECT_NEAR(ellipse->area_mm2, std::numbers::pi * ellipse->semi_major_mm * ellipse->semi_minor_mm, 1e-6);
}

// `text_width` is rather too large for any letters: nothing of the legend is cut off at the edge of the picture.
TEST(Stabilogram, Legend_FitsBesideThePath) {
  Prepared prepared = stretched_circle(200.0, 50.0, -85.0);
  prepared.mean_ml_mm = prepared.mean_ap_mm = -123.4;
  const auto document = parsed(drawn([&](Canvas& canvas) { draw_stabilogram(canvas, 92.5, 80.0, prepared, PlateSize{430.0, 430.0}); }));

  for (const pugi::xpath_node& found : document.select_nodes("//text[not(@text-anchor) and not(@transform)]")) {
    const pugi::xml_node text = found.node();
    const double end = text.attribute("x").as_double() + text_width(text.text().as_string(), text.attribute("font-size").as_double());
    EXPECT_LE(end, 92.5) << text.text().as_string();
    EXPECT_LE(text.attribute("y").as_double(), 80.0) << text.text().as_string();
  }
}

TEST(Stabilogram, EllipseOnPaper_IsToScaleWithTheGrid) {
  const Prepared prepared = stretched_circle(20.0, 5.0, 30.0);
  const auto document = parsed(drawn([&](Canvas& canvas) { draw_path(canvas, 40.0, 40.0, 1.5, prepared, 4000, 0.2); }));

  const pugi::xml_node ellipse = document.select_node("//ellipse").node();
  const auto outline = ellipse_outline(prepared);
  EXPECT_NEAR(ellipse.attribute("rx").as_double(), 1.5 * outline->semi_major_mm, 1e-3);
  EXPECT_NEAR(ellipse.attribute("ry").as_double(), 1.5 * outline->semi_minor_mm, 1e-3);
  EXPECT_STREQ(ellipse.attribute("transform").as_string(), "translate(40.00 40.00) rotate(-30.00)");
}

TEST(Stabilogram, FrontIsUpAndRightIsRight) {
  RecordProperty("requirement", "COP-1");
  Prepared prepared{.rate_hz = 100.0, .ml_mm = {0.0, 10.0}, .ap_mm = {0.0, 20.0}};
  const std::string text = drawn([&](Canvas& canvas) { draw_path(canvas, 50.0, 50.0, 1.0, prepared, 100, 0.2); });

  EXPECT_NE(text.find("M50.00 50.00L60.00 30.00"), std::string::npos) << text;
}

TEST(Stabilogram, CopAtRest_IsDrawnWithoutNan) {
  for (const std::size_t samples : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{500}}) {
    const Prepared prepared{.rate_hz = 100.0, .ml_mm = std::vector<double>(samples, 0.0), .ap_mm = std::vector<double>(samples, 0.0)};
    const std::string text = drawn([&](Canvas& canvas) { draw_stabilogram(canvas, 92.5, 80.0, prepared, PlateSize{430.0, 430.0}); });
    parsed(text);
    EXPECT_EQ(text.find("nan"), std::string::npos) << samples;
    EXPECT_EQ(text.find("inf"), std::string::npos) << samples;
  }
}

TEST(Stabilogram, Inset_ShowsThePlateOnlyWhenItIsKnown) {
  const Prepared prepared = stretched_circle(20.0, 5.0, 30.0);
  const auto with = drawn([&](Canvas& canvas) { draw_stabilogram(canvas, 92.5, 80.0, prepared, PlateSize{430.0, 400.0}); });
  const auto without = drawn([&](Canvas& canvas) { draw_stabilogram(canvas, 92.5, 80.0, prepared, std::nullopt); });

  EXPECT_NE(with.find("plate, 430 x"), std::string::npos);
  EXPECT_EQ(without.find("drawn area on"), std::string::npos);
}

TEST(SwaySeries, AGap_BreaksTheLine) {
  CopSeries whole{.rate_hz = 100.0, .ml_mm = std::vector<double>(300, 1.0), .ap_mm = std::vector<double>(300, 2.0)};
  CopSeries torn = whole;
  for (std::size_t index = 100; index < 150; ++index) torn.ml_mm[index] = torn.ap_mm[index] = kNan;

  const std::string with = drawn([&](Canvas& canvas) { draw_sway_series(canvas, 92.5, 43.0, torn, nullptr); });
  const std::string without = drawn([&](Canvas& canvas) { draw_sway_series(canvas, 92.5, 43.0, whole, nullptr); });

  EXPECT_EQ(count_of(with, "M"), count_of(without, "M") + 2) << "each of the two lines begins once more behind the gap";
  EXPECT_EQ(count_of(with, "#EEEEEE"), 2U) << "and the gap is shaded in both";
  EXPECT_EQ(with.find("nan"), std::string::npos);
}

TEST(SwaySeries, OddSeries_DoNotBreakThePicture) {
  for (const CopSeries& series : {CopSeries{}, CopSeries{.rate_hz = 100.0, .ml_mm = {1.0}, .ap_mm = {2.0}},
                                  CopSeries{.rate_hz = 100.0, .ml_mm = {kNan, kNan}, .ap_mm = {kNan, kNan}},
                                  CopSeries{.rate_hz = 100.0, .ml_mm = {1e308, -1e308}, .ap_mm = {0.0, 0.0}}}) {
    const std::string text = drawn([&](Canvas& canvas) { draw_sway_series(canvas, 92.5, 43.0, series, nullptr); });
    parsed(text);
    EXPECT_EQ(text.find("nan"), std::string::npos);
  }
}

TEST(Spectra, WithoutPower_SayWhy) {
  const std::string text = drawn([](Canvas& canvas) { draw_spectra(canvas, 92.5, 31.0, {}, {}, "needs 10 s"); });

  EXPECT_NE(text.find("no spectrum: needs 10 s"), std::string::npos);
}

TEST(Outline, Thinned_KeepsPeaksOfBothAndEnds) {
  std::vector<double> first(100'000, 0.0);
  std::vector<double> second(100'000, 0.0);
  // Within one stretch a smaller peak follows the largest.
  const std::vector<std::size_t> peaks{54'321, 77'777, 54'400, 77'800};
  first[peaks[0]] = second[peaks[2]] = 7.0;
  first[peaks[1]] = second[peaks[3]] = -7.0;
  for (const std::size_t peak : peaks) (first[peak] != 0.0 ? first : second)[peak + 1] = first[peak] + second[peak] > 0.0 ? 3.0 : -3.0;

  const auto kept = thinned(first, second, 1000);

  EXPECT_LE(kept.size(), 1500U);
  EXPECT_EQ(kept.front(), 0U);
  EXPECT_EQ(kept.back(), first.size() - 1);
  for (const std::size_t peak : peaks) EXPECT_TRUE(std::ranges::binary_search(kept, peak)) << peak;
}

TEST(Outline, ShortSeries_IsKeptWhole) {
  const std::vector<double> values{1.0, 1.0, 2.0, kNan, kNan, 3.0};

  EXPECT_EQ(thinned(values, values, 100), (std::vector<std::size_t>{0, 1, 2, 3, 5}));
}

TEST(Outline, SeriesInShreds_StaysSmall) {
  std::vector<double> values(200'000, 0.0);
  for (std::size_t index = 0; index < values.size(); index += 2) values[index] = kNan;

  EXPECT_LE(thinned(values, values, 1000).size(), 4000U);
}

TEST(Outline, Path_BeginsAnewBehindAGap) {
  const std::vector<PlotPoint> points{{0, 0}, {1, 1}, {kNan, kNan}, {3, 3}, {kNan, 0}, {5, 5}, {6, 6}};

  EXPECT_EQ(path_data(points), "M0.00 0.00L1.00 1.00M3.00 3.00h0.01M5.00 5.00L6.00 6.00");
}

TEST(Canvas, Text_IsEscapedAndCleaned) {
  const std::string text = drawn([](Canvas& canvas) { canvas.text(0, 0, "<script>alert('x')</script> & \x01 \xff \"q\""); });

  const auto document = parsed(text);
  EXPECT_EQ(text.find("<script"), std::string::npos);
  EXPECT_STREQ(document.select_node("//text").node().text().as_string(), "<script>alert('x')</script> & \xef\xbf\xbd \xef\xbf\xbd \"q\"");
}

TEST(SvgPage, LongNameOfAFact_IsBrokenBeforeItsValue) {
  const std::string text = svg_of(
      {.title = "T", .subtitle = "", .facts = {{.name = "Largest reach of a person", .value = "124 cm"}}, .alerts = {}, .sections = {}});
  EXPECT_EQ(text.find("Largest reach of a person"), std::string::npos) << "printed over its value";
  EXPECT_NE(text.find(">Largest"), std::string::npos);
  EXPECT_NE(text.find(">124 cm"), std::string::npos);
}

}  // namespace
}  // namespace dts::report
