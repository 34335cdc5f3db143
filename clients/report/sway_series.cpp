// SPDX-License-Identifier: Apache-2.0
#include "report/sway_series.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "report/number_text.h"
#include "report/outline.h"
#include "report/ticks.h"

namespace dts::report {
namespace {

using posturography::CopSeries;
using posturography::Prepared;

constexpr std::size_t kSeriesMostPoints = 4000;
constexpr std::size_t kMostGaps = 200;
constexpr double kSeriesLeft = 11.0;
constexpr double kSeriesRight = 1.0;
constexpr double kSeriesBottom = 7.5;
constexpr double kBetween = 2.5;

struct Panel {
  double top, height;
  double left, width;
  double length_s;
  double half_mm;

  [[nodiscard]] double x(double t_s) const { return left + width * t_s / length_s; }
  [[nodiscard]] double y(double mm) const { return top + height / 2.0 - mm * height / 2.0 / half_mm; }
};

/// One axis of the COP.
struct Lane {
  const std::vector<double>& recorded_mm;
  const std::vector<double>* analysed_mm;
  double mean_mm;
  std::string_view colour;
  std::string name;
  std::string positive;
  std::string negative;
};

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// Returns the recorded values outside [begin, end) and NaN within, so that nothing is drawn twice.
std::vector<double> beside(const Lane& lane, double begin_s, double end_s, double rate_hz) {
  std::vector<double> values = lane.recorded_mm;
  for (std::size_t index = 0; index < values.size(); ++index) {
    const double t_s = static_cast<double>(index) / rate_hz;
    if (lane.analysed_mm != nullptr && t_s > begin_s && t_s < end_s)
      values[index] = std::numeric_limits<double>::quiet_NaN();
    else
      values[index] -= lane.mean_mm;
  }
  return values;
}

void draw_line(Canvas& canvas, const Panel& panel, const std::vector<double>& values, double begins_s, double rate_hz,
               const Stroke& stroke) {
  std::vector<PlotPoint> points;
  for (const std::size_t index : thinned(values, values, kSeriesMostPoints)) {
    const double mm = std::isfinite(values[index]) ? std::clamp(values[index], -panel.half_mm, panel.half_mm) : values[index];
    points.push_back({.x = panel.x(begins_s + static_cast<double>(index) / rate_hz), .y = panel.y(mm)});
  }
  canvas.path(path_data(points), stroke);
}

void draw_gaps(Canvas& canvas, const Panel& panel, const CopSeries& recorded) {
  std::size_t drawn = 0;
  for (const Gap& gap : gaps_of(recorded.ml_mm)) {
    if (++drawn > kMostGaps) break;
    const double left = panel.x(static_cast<double>(gap.begin) / recorded.rate_hz);
    const double right = panel.x(static_cast<double>(gap.end) / recorded.rate_hz);
    canvas.rect(left, panel.top, std::max(right - left, 0.15), panel.height, colour::kShade, {.colour = colour::kNone});
  }
}

void draw_frame(Canvas& canvas, const Panel& panel, const Lane& lane) {
  const Ticks ticks = round_ticks(-panel.half_mm, panel.half_mm, 5);
  for (const double mm : ticks.at) {
    canvas.line(panel.left, panel.y(mm), panel.left + panel.width, panel.y(mm),
                {.colour = std::abs(mm) < ticks.step / 2.0 ? colour::kGrey : colour::kGrid, .width = 0.15});
    canvas.text(panel.left - 0.8, panel.y(mm) + 0.7, ticks.label(mm),
                {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
  }
  canvas.rect(panel.left, panel.top, panel.width, panel.height, colour::kNone, {.colour = colour::kGrey, .width = 0.2});
  const double title_x = panel.left - 8.0;
  canvas.text(title_x, panel.top + panel.height / 2.0, lane.name + ", mm",
              {.size = 2.4, .anchor = Anchor::Middle, .colour = lane.colour, .is_bold = true, .is_upward = true});
  canvas.text(panel.left + 0.8, panel.top + 2.3, lane.positive, {.size = kSmallText, .colour = colour::kDarkGrey});
  canvas.text(panel.left + 0.8, panel.top + panel.height - 0.8, lane.negative, {.size = kSmallText, .colour = colour::kDarkGrey});
}

void draw_time_axis(Canvas& canvas, const Panel& panel, const Panel& first) {
  const Ticks ticks = round_ticks(0.0, panel.length_s, 8);
  const double bottom = panel.top + panel.height;
  for (const double t_s : ticks.at) {
    const Stroke stroke{.colour = colour::kGrid, .width = 0.15};
    canvas.line(panel.x(t_s), first.top, panel.x(t_s), first.top + first.height, stroke);
    canvas.line(panel.x(t_s), panel.top, panel.x(t_s), bottom, stroke);
    canvas.text(panel.x(t_s), bottom + 2.8, ticks.label(t_s),
                {.size = kSmallText, .anchor = t_s > 0.97 * panel.length_s ? Anchor::End : Anchor::Middle, .colour = colour::kDarkGrey});
  }
  canvas.text(panel.left + panel.width / 2.0, bottom + 6.0, "time since the start of the measurement, s",
              {.size = 2.4, .anchor = Anchor::Middle});
}

void draw_lane(Canvas& canvas, const Panel& panel, const Lane& lane, const CopSeries& recorded, const Prepared* prepared) {
  const double begin_s = prepared == nullptr ? 0.0 : prepared->begins_s;
  const double end_s = prepared == nullptr ? 0.0 : begin_s + prepared->duration_s();
  draw_line(canvas, panel, beside(lane, begin_s, end_s, recorded.rate_hz), 0.0, recorded.rate_hz, {.colour = colour::kGrey, .width = 0.15});
  if (lane.analysed_mm != nullptr) {
    draw_line(canvas, panel, *lane.analysed_mm, begin_s, prepared->rate_hz, {.colour = lane.colour, .width = 0.22});
  }
}

double half_mm(const CopSeries& recorded, const Prepared* prepared, double mean_ml_mm, double mean_ap_mm) {
  double half = 1.0;
  const auto widen = [&half](const std::vector<double>& values, double mean_mm) {
    for (const double value : values) half = std::isfinite(value) ? std::max(half, std::abs(value - mean_mm)) : half;
  };
  if (prepared == nullptr) {
    widen(recorded.ml_mm, mean_ml_mm);
    widen(recorded.ap_mm, mean_ap_mm);
  } else {  // values outside the analysed part may be from stepping off the plate: they are cut off at the frame
    widen(prepared->ml_mm, 0.0);
    widen(prepared->ap_mm, 0.0);
  }
  return 1.08 * half;
}

}  // namespace

void draw_sway_series(Canvas& canvas, double width, double height, const CopSeries& recorded, const Prepared* prepared) {
  if (recorded.ml_mm.empty() || !(recorded.rate_hz > 0.0)) {
    canvas.text(width / 2.0, height / 2.0, "no samples", {.anchor = Anchor::Middle, .colour = colour::kDarkGrey});
    return;
  }
  const double mean_ml_mm = prepared == nullptr ? mean_of(recorded.ml_mm) : prepared->mean_ml_mm;
  const double mean_ap_mm = prepared == nullptr ? mean_of(recorded.ap_mm) : prepared->mean_ap_mm;
  const double panel_height = (height - kSeriesBottom - kBetween) / 2.0;
  Panel panel{.top = 0.2,
              .height = panel_height,
              .left = kSeriesLeft,
              .width = width - kSeriesLeft - kSeriesRight,
              .length_s = static_cast<double>(recorded.ml_mm.size()) / recorded.rate_hz,
              .half_mm = half_mm(recorded, prepared, mean_ml_mm, mean_ap_mm)};
  Panel lower = panel;
  lower.top += panel_height + kBetween;
  const Lane ap{recorded.ap_mm, prepared == nullptr ? nullptr : &prepared->ap_mm, mean_ap_mm, colour::kBlue, "AP", "front", "back"};
  const Lane ml{recorded.ml_mm, prepared == nullptr ? nullptr : &prepared->ml_mm, mean_ml_mm, colour::kVermillion, "ML", "right", "left"};
  draw_gaps(canvas, panel, recorded);
  draw_gaps(canvas, lower, recorded);
  draw_time_axis(canvas, lower, panel);
  draw_frame(canvas, panel, ap);
  draw_frame(canvas, lower, ml);
  draw_lane(canvas, panel, ap, recorded, prepared);
  draw_lane(canvas, lower, ml, recorded, prepared);
}

}  // namespace dts::report
