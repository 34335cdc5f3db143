// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/pair_pictures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "report/number_text.h"
#include "report/outline.h"
#include "report/ticks.h"

namespace dts::lab::compare {
namespace {

using report::Anchor;
using report::Canvas;
using report::PlotPoint;
namespace colour = report::colour;

constexpr double kOverlayMm = 45.0;
constexpr double kAgreementMm = 60.0;
constexpr double kLeftMm = 11.0;
constexpr double kRightMm = 2.0;
constexpr double kTopMm = 4.0;
constexpr double kBottomMm = 8.0;
constexpr std::size_t kMostLinePoints = 4000;
constexpr std::size_t kMostDots = 3000;
constexpr double kDotMm = 0.4;
constexpr double kCutOff = 0.005;  ///< Part of the values at either end that may lie outside a picture.
constexpr double kMargin = 0.25;

struct Range {
  double low = 0.0;
  double high = 1.0;
};

/// Returns the range of nearly all values, with a margin; not empty. A few values far off the others would hide the rest: stepping on.
Range range_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto at = [&](double part) { return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))]; };
  const double margin = std::max(kMargin * (at(1.0 - kCutOff) - at(kCutOff)), 0.01);
  return {.low = std::max(values.front() - margin / 2.0, at(kCutOff) - margin),
          .high = std::min(values.back() + margin / 2.0, at(1.0 - kCutOff) + margin)};
}

/// Returns both series one after the other.
std::vector<double> both(std::vector<double> first, const std::vector<double>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// A frame with axes: mm on the paper from values.
class Frame {
 public:
  Frame(double width_mm, double height_mm, Range x, Range y)
      : width_mm_(width_mm - kLeftMm - kRightMm), height_mm_(height_mm - kTopMm - kBottomMm), x_(x), y_(y) {}

  [[nodiscard]] double x(double value) const { return kLeftMm + width_mm_ * (value - x_.low) / (x_.high - x_.low); }
  [[nodiscard]] bool has(double x, double y) const { return x >= x_.low && x <= x_.high && y >= y_.low && y <= y_.high; }
  [[nodiscard]] double y_cut(double value) const { return std::isfinite(value) ? y(std::clamp(value, y_.low, y_.high)) : value; }
  [[nodiscard]] double y(double value) const { return kTopMm + height_mm_ * (y_.high - value) / (y_.high - y_.low); }

  void draw(Canvas& canvas, const std::string& x_label, const std::string& y_label) const {
    const report::TextStyle small{.size = report::kSmallText, .anchor = Anchor::Middle, .colour = colour::kDarkGrey};
    const double bottom = kTopMm + height_mm_;
    for (const report::Ticks ticks = report::round_ticks(x_.low, x_.high, 8); const double at : ticks.at) {
      canvas.line(x(at), kTopMm, x(at), bottom, {.colour = colour::kGrid, .width = 0.15});
      canvas.text(x(at), bottom + 2.8, ticks.label(at), small);
    }
    report::TextStyle beside = small;
    beside.anchor = Anchor::End;
    for (const report::Ticks ticks = report::round_ticks(y_.low, y_.high, 6); const double at : ticks.at) {
      canvas.line(kLeftMm, y(at), kLeftMm + width_mm_, y(at), {.colour = colour::kGrid, .width = 0.15});
      canvas.text(kLeftMm - 0.8, y(at) + 0.7, ticks.label(at), beside);
    }
    canvas.rect(kLeftMm, kTopMm, width_mm_, height_mm_, colour::kNone, {.colour = colour::kGrey, .width = 0.2});
    canvas.text(kLeftMm + width_mm_ / 2.0, bottom + 6.3, x_label, {.size = 2.4, .anchor = Anchor::Middle});
    canvas.text(2.6, kTopMm + height_mm_ / 2.0, y_label, {.size = 2.4, .anchor = Anchor::Middle, .is_upward = true});
  }

  /// Draws a horizontal line with its value at the right end, above or below.
  void level(Canvas& canvas, double value, const std::string& text, bool is_above, const report::Stroke& stroke) const {
    canvas.line(kLeftMm, y(value), kLeftMm + width_mm_, y(value), stroke);
    canvas.text(kLeftMm + width_mm_ - 0.6, y(value) + (is_above ? -0.7 : 2.3), text + " " + report::fixed(value, 2),
                {.size = report::kSmallText, .anchor = Anchor::End, .colour = stroke.colour});
  }

 private:
  double width_mm_;
  double height_mm_;
  Range x_;
  Range y_;
};

std::vector<double> without_mean(const std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(std::max<std::size_t>(1, values.size()));
  std::vector<double> result;
  for (const double value : values) result.push_back(value - mean);
  return result;
}

/// Returns where a line over these times must break.
std::vector<bool> breaks_of(const std::vector<double>& t_s) {
  constexpr double kGapSteps = 3.5;
  std::vector<double> steps;
  for (std::size_t k = 1; k < t_s.size(); ++k) steps.push_back(t_s[k] - t_s[k - 1]);
  std::vector<bool> breaks(t_s.size(), false);
  if (steps.empty()) return breaks;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  for (std::size_t k = 1; k < t_s.size(); ++k) breaks[k] = t_s[k] - t_s[k - 1] > kGapSteps * *middle;
  return breaks;
}

void draw_line(Canvas& canvas, const Frame& frame, const std::vector<double>& t_s, const std::vector<double>& values,
               const report::Stroke& stroke) {
  const std::vector<bool> breaks = breaks_of(t_s);
  std::vector<PlotPoint> points;
  std::size_t last = 0;
  for (const std::size_t index : report::thinned(values, values, kMostLinePoints)) {
    const bool has_gap =
        std::find(breaks.begin() + static_cast<std::ptrdiff_t>(last) + 1, breaks.begin() + static_cast<std::ptrdiff_t>(index) + 1, true) !=
        breaks.begin() + static_cast<std::ptrdiff_t>(index) + 1;
    if (index > last && has_gap) points.push_back({.x = std::nan(""), .y = std::nan("")});
    points.push_back({.x = frame.x(t_s[index]), .y = frame.y_cut(values[index])});
    last = index;
  }
  canvas.path(report::path_data(points), stroke);
}

}  // namespace

report::Figure overlay_figure(const Paired& paired, const PairAxis& axis, const std::string& name_a, const std::string& name_b) {
  const auto draw = [&paired, axis, name_a, name_b](Canvas& canvas) {
    const std::vector<double> a = without_mean(axis.a_mm);
    const std::vector<double> b = without_mean(axis.b_mm);
    const Frame frame(report::kFullWidthMm, kOverlayMm, {.low = paired.t_a_s.front(), .high = paired.t_a_s.back()}, range_of(both(a, b)));
    frame.draw(canvas, "time since the first scan of A, s", axis.name + " less its mean, mm");
    draw_line(canvas, frame, paired.t_a_s, a, {.colour = colour::kBlue, .width = 0.25});
    draw_line(canvas, frame, paired.t_a_s, b, {.colour = colour::kVermillion, .width = 0.18});
    canvas.text(kLeftMm, 2.8, "A: " + name_a, {.size = report::kSmallText, .colour = colour::kBlue});
    canvas.text(report::kFullWidthMm / 2.0, 2.8, "B: " + name_b, {.size = report::kSmallText, .colour = colour::kVermillion});
  };
  return {.title = axis.name + ": both recordings", .width_mm = report::kFullWidthMm, .height_mm = kOverlayMm, .draw = draw};
}

report::Figure agreement_figure(const PairAxis& axis) {
  const auto draw = [axis](Canvas& canvas) {
    std::vector<double> means;
    std::vector<double> differences;
    for (std::size_t k = 0; k < axis.a_mm.size(); ++k) {
      means.push_back((axis.a_mm[k] + axis.b_mm[k]) / 2.0);
      differences.push_back(axis.b_mm[k] - axis.a_mm[k]);
    }
    const AxisDifference& difference = axis.difference;
    Range y = range_of(differences);
    const double room_mm = 0.15 * (difference.upper_limit_mm - difference.lower_limit_mm) + 0.01;
    y = {.low = std::min(y.low, difference.lower_limit_mm - room_mm), .high = std::max(y.high, difference.upper_limit_mm + room_mm)};
    const Frame frame(report::kHalfWidthMm, kAgreementMm, range_of(means), y);
    frame.draw(canvas, "mean of A and B, mm", "B - A, mm");
    std::vector<PlotPoint> dots;
    for (std::size_t k = 0; k < means.size(); k += 1 + means.size() / kMostDots) {
      if (!frame.has(means[k], differences[k])) continue;
      dots.push_back({.x = frame.x(means[k]) - kDotMm / 2.0, .y = frame.y(differences[k])});
      dots.push_back({.x = frame.x(means[k]) + kDotMm / 2.0, .y = frame.y(differences[k])});
      dots.push_back({.x = std::nan(""), .y = std::nan("")});
    }
    canvas.path(report::path_data(dots), {.colour = colour::kGrey, .width = kDotMm});
    std::size_t outside = 0;
    for (std::size_t k = 0; k < means.size(); ++k) outside += frame.has(means[k], differences[k]) ? 0 : 1;
    if (outside > 0) {
      canvas.text(kLeftMm, 2.8, std::to_string(outside) + " of " + std::to_string(means.size()) + " scans are outside this picture",
                  {.size = report::kSmallText, .colour = colour::kDarkGrey});
    }
    const report::Stroke limit{.colour = colour::kVermillion, .width = 0.25, .dash = "1.5 0.8"};
    frame.level(canvas, difference.upper_limit_mm, "+1.96 SD", true, limit);
    frame.level(canvas, difference.mean_difference_mm, "bias", true, {.colour = colour::kBlue, .width = 0.3});
    frame.level(canvas, difference.lower_limit_mm, "-1.96 SD", false, limit);
  };
  return {.title = axis.name + ": Bland-Altman", .width_mm = report::kHalfWidthMm, .height_mm = kAgreementMm, .draw = draw};
}

}  // namespace dts::lab::compare
