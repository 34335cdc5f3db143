// SPDX-License-Identifier: Apache-2.0
#include "report/chair_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "physics/body/person.h"
#include "report/chair_words.h"
#include "report/number_text.h"
#include "report/outline.h"
#include "report/page_parts.h"
#include "report/ticks.h"

namespace dts::report {
namespace {

using core::TrunkClass;

constexpr std::size_t kTracePoints = 4000;
constexpr std::size_t kOverlayPoints = 400;
constexpr double kAxisLeft = 11.0;
constexpr double kAxisBottom = 7.5;
constexpr double kHighestDeg = 90.0;
constexpr std::size_t kMostOverlays = 60;  // per target
constexpr double kOverlayBeforeS = 0.5;
constexpr double kOverlayAfterS = 3.0;

struct ClassBand {
  TrunkClass trunk_class;
  double from_deg;
  double to_deg;
};
constexpr std::array<ClassBand, 3> kBands{{{TrunkClass::Minor, 0.0, physics::kModerateFromDeg},
                                           {TrunkClass::Moderate, physics::kModerateFromDeg, physics::kMaximumFromDeg},
                                           {TrunkClass::Maximum, physics::kMaximumFromDeg, kHighestDeg}}};

/// A frame with linear axes.
struct Axes {
  double left, top, width, height;
  double x_low, x_high;
  double y_low, y_high;

  [[nodiscard]] double x(double value) const { return left + width * (value - x_low) / (x_high - x_low); }
  [[nodiscard]] double y(double value) const { return top + height * (y_high - value) / (y_high - y_low); }
  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
};

const Stroke kGridStroke{.colour = colour::kGrid, .width = 0.15};
const Stroke kFrameStroke{.colour = colour::kGrey, .width = 0.2};
const TextStyle kAxisText{.size = kSmallText, .anchor = Anchor::Middle, .colour = colour::kDarkGrey};

void draw_y_axis(Canvas& canvas, const Axes& axes, const std::string& name) {
  const Ticks ticks = round_ticks(axes.y_low, axes.y_high, 7);
  for (const double value : ticks.at) {
    canvas.line(axes.left, axes.y(value), axes.right(), axes.y(value), kGridStroke);
    canvas.text(axes.left - 0.8, axes.y(value) + 0.7, ticks.label(value),
                {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
  }
  if (!name.empty())
    canvas.text(axes.left - 8.0, axes.top + axes.height / 2.0, name, {.size = 2.4, .anchor = Anchor::Middle, .is_upward = true});
}

void draw_x_axis(Canvas& canvas, const Axes& axes, const std::string& name, std::size_t most) {
  const Ticks ticks = round_ticks(axes.x_low, axes.x_high, most);
  for (const double value : ticks.at) {
    canvas.line(axes.x(value), axes.top, axes.x(value), axes.bottom(), kGridStroke);
    canvas.text(axes.x(value), axes.bottom() + 2.8, ticks.label(value), kAxisText);
  }
  if (!name.empty()) canvas.text(axes.left + axes.width / 2.0, axes.bottom() + 6.0, name, {.size = 2.4, .anchor = Anchor::Middle});
}

/// Draws values at a constant rate from `begin_s` on; what is outside the axes is left out.
void draw_values(Canvas& canvas, const Axes& axes, const std::vector<double>& values, double begin_s, double rate_hz, double minus,
                 std::size_t most, const Stroke& stroke) {
  std::vector<PlotPoint> points;
  for (const std::size_t index : thinned(values, values, most)) {
    const double t_s = begin_s + static_cast<double>(index) / rate_hz;
    if (t_s < axes.x_low || t_s > axes.x_high) continue;
    const double value = values[index] - minus;
    points.push_back({.x = axes.x(t_s), .y = axes.y(std::isfinite(value) ? std::clamp(value, axes.y_low, axes.y_high) : value)});
  }
  canvas.path(path_data(points), stroke);
}

/// Returns the smallest and the largest value with a margin; nothing if there is no value.
std::optional<std::pair<double, double>> range_of(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low <= high)) return std::nullopt;
  const double margin = std::max(0.1 * (high - low), 0.05);
  return std::pair(low - margin, high + margin);
}

struct PointMark {
  const char* name;
  const core::ReachPoint& point;
  double dx, dy;
  Anchor anchor;
};

void draw_points(Canvas& canvas, const Axes& axes, const ChairTrial& trial, const core::ReachEvent& reach) {
  const auto x = [&](const core::ReachPoint& point) { return axes.x(std::clamp(trial.after_cue_s(point.scan), axes.x_low, axes.x_high)); };
  const auto y = [&](double mm) { return axes.y(std::clamp(mm, axes.y_low, axes.y_high)); };
  canvas.line(axes.left, y(reach.p1.value_mm), axes.right(), y(reach.p1.value_mm),
              {.colour = colour::kDarkGrey, .width = 0.15, .dash = "1 0.8"});
  // d1 and d2 are heights above and below the level of P1: as arrows without heads, beside the points.
  const Stroke height{.colour = colour::kVermillion, .width = 0.3};
  if (reach.p2.scan.value > reach.p1.scan.value) {
    canvas.line(x(reach.p2), y(reach.p1.value_mm), x(reach.p2), y(reach.p2.value_mm), height);
    canvas.text(x(reach.p2) + 1.0, y((reach.p1.value_mm + reach.p2.value_mm) / 2.0) + 0.8, "d1",
                {.size = kSmallText, .colour = colour::kVermillion});
  }
  canvas.line(x(reach.p3), y(reach.p1.value_mm), x(reach.p3), y(reach.p3.value_mm), height);
  canvas.text(x(reach.p3) + 1.0, y((reach.p1.value_mm + reach.p3.value_mm) / 2.0) + 0.8, "d2",
              {.size = kSmallText, .colour = colour::kVermillion});
  for (const PointMark& mark : {PointMark{"P1", reach.p1, -1.2, -1.4, Anchor::End}, PointMark{"P2", reach.p2, 0.0, 3.4, Anchor::Middle},
                                PointMark{"P3", reach.p3, 0.0, -1.6, Anchor::Middle}}) {
    canvas.circle(x(mark.point), y(mark.point.value_mm), 0.8, "#FFFFFF", {.colour = colour::kVermillion, .width = 0.4});
    canvas.text(x(mark.point) + mark.dx, y(mark.point.value_mm) + mark.dy, mark.name,
                {.size = 2.6, .anchor = mark.anchor, .colour = colour::kVermillion, .is_bold = true});
  }
}

void draw_class_bands(Canvas& canvas, const Axes& axes) {
  for (const ClassBand& band : kBands) {
    if (band.trunk_class == TrunkClass::Moderate) {
      canvas.rect(axes.left, axes.y(band.to_deg), axes.width, axes.y(band.from_deg) - axes.y(band.to_deg), colour::kShade,
                  {.colour = colour::kNone});
    }
    canvas.text(axes.right() - 0.8, axes.y((band.from_deg + std::min(band.to_deg, axes.y_high)) / 2.0) + 0.7, class_word(band.trunk_class),
                {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
  }
}

/// Draws one trial: filled if it has a class, open if it was rejected; with its interval.
void draw_angle(Canvas& canvas, const Axes& axes, double x, const core::TrunkMovement& movement) {
  const auto y = [&axes](double deg) { return axes.y(std::clamp(deg, axes.y_low, axes.y_high)); };
  if (std::isfinite(movement.trunk_lo_deg) && std::isfinite(movement.trunk_hi_deg))
    canvas.line(x, y(movement.trunk_lo_deg), x, y(movement.trunk_hi_deg), {.colour = colour::kGrey, .width = 0.2});
  const bool is_rejected = movement.trunk_class == TrunkClass::Rejected;
  canvas.circle(x, y(movement.trunk_deg), 0.65, is_rejected ? "#FFFFFF" : colour::kBlue,
                {.colour = is_rejected ? colour::kVermillion : colour::kBlue, .width = 0.25});
}

/// Breaks a short text into at most two lines at a space.
std::array<std::string, 2> two_lines(const std::string& text, double width_mm) {
  if (text_width(text, kSmallText) <= width_mm) return {text, ""};
  std::size_t cut = std::string::npos;
  for (std::size_t place = text.find(' '); place != std::string::npos; place = text.find(' ', place + 1)) {
    if (cut == std::string::npos || text_width(text.substr(0, place), kSmallText) <= width_mm) cut = place;
  }
  if (cut == std::string::npos) return {text, ""};
  return {text.substr(0, cut), text.substr(cut + 1)};
}

}  // namespace

std::vector<const ChairTrial*> trials_to(const ChairData& chair, const session::TargetSummary& target) {
  std::vector<const ChairTrial*> trials;
  for (const ChairTrial& trial : chair.trials) {
    const bool is_its =
        trial.recorded.condition == target.condition && trial.recorded.result && trial.recorded.result->target_cm == target.target_cm;
    if (is_its && trial.counts()) trials.push_back(&trial);
  }
  return trials;
}

std::string target_text(const ChairData& chair, const std::string& condition) {
  return condition.empty() ? "no target" : condition_text(chair, condition);
}

void draw_transient(Canvas& canvas, double width, double height, const ChairTrial& trial) {
  const TransientTrace& trace = trial.trace;
  const auto range = range_of(trace.mm);
  if (!range) {
    const std::string why = trace.problem.empty() ? "no samples" : trace.problem;
    canvas.text(width / 2.0, height / 2.0, why, {.anchor = Anchor::Middle, .colour = colour::kDarkGrey});
    return;
  }
  const double end_s = trace.begin_s + static_cast<double>(trace.mm.size()) / trace.rate_hz;
  const Axes axes{.left = kAxisLeft,
                  .top = 0.2,
                  .width = width - kAxisLeft - 1.0,
                  .height = height - kAxisBottom,
                  .x_low = trace.begin_s,
                  .x_high = std::max(end_s, trace.begin_s + 0.1),
                  .y_low = range->first,
                  .y_high = range->second};
  const core::ReachEvent* reach = trial.reach();
  if (reach != nullptr) {
    const double from = axes.x(std::clamp(trial.after_cue_s(reach->p1.scan), axes.x_low, axes.x_high));
    const double to = axes.x(std::clamp(trial.after_cue_s(reach->p2.scan), axes.x_low, axes.x_high));
    if (to > from) canvas.rect(from, axes.top, to - from, axes.height, colour::kShade, {.colour = colour::kNone});
  }
  draw_y_axis(canvas, axes, "mean deflection of the seat, mm");
  draw_x_axis(canvas, axes, "time after the cue, s", 12);
  for (const Gap& gap : gaps_of(trace.mm)) {
    const double left = axes.x(trace.begin_s + static_cast<double>(gap.begin) / trace.rate_hz);
    const double right = axes.x(trace.begin_s + static_cast<double>(gap.end) / trace.rate_hz);
    canvas.rect(left, axes.top, std::max(right - left, 0.15), axes.height, colour::kWarningShade, {.colour = colour::kNone});
  }
  canvas.line(axes.x(0.0), axes.top, axes.x(0.0), axes.bottom(), {.colour = colour::kGreen, .width = 0.4});
  canvas.text(axes.x(0.0) + 0.8, axes.top + 2.6, "cue", {.size = 2.4, .colour = colour::kGreen, .is_bold = true});
  draw_values(canvas, axes, trace.mm, trace.begin_s, trace.rate_hz, 0.0, kTracePoints, {.colour = colour::kGrey, .width = 0.12});
  draw_values(canvas, axes, trace.smoothed(), trace.begin_s, trace.rate_hz, 0.0, kTracePoints, {.colour = colour::kBlue, .width = 0.35});
  canvas.rect(axes.left, axes.top, axes.width, axes.height, colour::kNone, kFrameStroke);
  if (reach != nullptr) draw_points(canvas, axes, trial, *reach);
}

void draw_trunk_scale(Canvas& canvas, double width, double height, const ChairTrial& trial) {
  const Axes axes{.left = 2.0,
                  .top = 4.0,
                  .width = width - 4.0,
                  .height = height - 12.0,
                  .x_low = 0.0,
                  .x_high = kHighestDeg,
                  .y_low = 0.0,
                  .y_high = 1.0};
  TrunkClass expected = TrunkClass::None;  // has no band of its own
  if (trial.recorded.result && trial.recorded.result->expected) expected = *trial.recorded.result->expected;
  for (const ClassBand& band : kBands) {
    const bool is_expected = expected == band.trunk_class;
    canvas.rect(axes.x(band.from_deg), axes.top, axes.x(band.to_deg) - axes.x(band.from_deg), axes.height,
                is_expected ? colour::kShade : "#FFFFFF", kFrameStroke);
    canvas.text(axes.x((band.from_deg + band.to_deg) / 2.0), axes.top - 1.2, class_word(band.trunk_class),
                {.size = 2.4, .anchor = Anchor::Middle, .is_bold = is_expected});
  }
  const Ticks ticks = round_ticks(0.0, kHighestDeg, 10);
  for (const double deg : ticks.at) {
    canvas.line(axes.x(deg), axes.bottom(), axes.x(deg), axes.bottom() + 0.8, kFrameStroke);
    canvas.text(axes.x(deg), axes.bottom() + 3.2, ticks.label(deg), kAxisText);
  }
  canvas.text(axes.left + axes.width / 2.0, axes.bottom() + 6.6, "trunk angle at P3, \u00B0 forward; grey: expected for this target",
              {.size = 2.4, .anchor = Anchor::Middle});
  const core::TrunkMovement* movement = trial.movement();
  if (movement == nullptr || !std::isfinite(movement->trunk_deg)) {
    canvas.text(axes.left + axes.width / 2.0, axes.y(0.5) + 0.8, "no angle", {.anchor = Anchor::Middle, .colour = colour::kDarkGrey});
    return;
  }
  const auto x = [&axes](double deg) { return axes.x(std::clamp(deg, 0.0, kHighestDeg)); };
  if (std::isfinite(movement->trunk_lo_deg) && std::isfinite(movement->trunk_hi_deg)) {
    const Stroke bar{.colour = colour::kBlue, .width = 0.6};
    canvas.line(x(movement->trunk_lo_deg), axes.y(0.5), x(movement->trunk_hi_deg), axes.y(0.5), bar);
    for (const double end_deg : {movement->trunk_lo_deg, movement->trunk_hi_deg})
      canvas.line(x(end_deg), axes.y(0.5) - 1.2, x(end_deg), axes.y(0.5) + 1.2, bar);
  }
  canvas.circle(x(movement->trunk_deg), axes.y(0.5), 1.3, movement->trunk_class == TrunkClass::Rejected ? "#FFFFFF" : colour::kBlue,
                {.colour = colour::kBlue, .width = 0.5});
}

void draw_angles(Canvas& canvas, double width, double height, const ChairData& chair) {
  double highest = 20.0;
  for (const ChairTrial& trial : chair.trials) {
    if (trial.counts() && trial.movement() != nullptr && std::isfinite(trial.movement()->trunk_hi_deg))
      highest = std::max(highest, std::min(trial.movement()->trunk_hi_deg, kHighestDeg));
  }
  const Axes axes{.left = kAxisLeft,
                  .top = 0.2,
                  .width = width - kAxisLeft - 1.0,
                  .height = height - 10.0,
                  .x_low = 0.0,
                  .x_high = 1.0,
                  .y_low = -2.0,
                  .y_high = std::max(highest + 8.0, physics::kMaximumFromDeg + 10.0)};
  draw_class_bands(canvas, axes);
  draw_y_axis(canvas, axes, "trunk angle at P3, \u00B0");
  canvas.text(axes.left + 1.0, axes.top + 2.6, "line: 90 % interval; black: mean and SD; open: rejected",
              {.size = kSmallText, .colour = colour::kDarkGrey});
  canvas.rect(axes.left, axes.top, axes.width, axes.height, colour::kNone, kFrameStroke);
  const std::size_t targets = std::min(chair.targets.size(), kMostTargetsDrawn);
  const double pitch = (axes.width - 10.0) / static_cast<double>(std::max<std::size_t>(targets, 1));
  for (std::size_t index = 0; index < targets; ++index) {
    const session::TargetSummary& target = chair.targets[index];
    const double left = axes.left + pitch * static_cast<double>(index);
    const auto trials = trials_to(chair, target);
    const double step = 0.7 * pitch / static_cast<double>(std::max<std::size_t>(trials.size(), 1));
    for (std::size_t k = 0; k < trials.size(); ++k) {
      if (trials[k]->movement() == nullptr || !std::isfinite(trials[k]->movement()->trunk_deg)) continue;
      draw_angle(canvas, axes, left + 0.1 * pitch + step * (static_cast<double>(k) + 0.5), *trials[k]->movement());
    }
    if (target.trunk_deg.mean) {
      const double x = left + 0.88 * pitch;
      const double mean = *target.trunk_deg.mean;
      const double spread = target.trunk_deg.deviation.value_or(0.0);
      const auto y = [&axes](double deg) { return axes.y(std::clamp(deg, axes.y_low, axes.y_high)); };
      canvas.line(x, y(mean - spread), x, y(mean + spread), {.colour = colour::kBlack, .width = 0.4});
      canvas.line(x - 1.2, y(mean), x + 1.2, y(mean), {.colour = colour::kBlack, .width = 0.5});
    }
    const auto lines = two_lines(target_text(chair, target.condition), pitch - 1.0);
    for (std::size_t line = 0; line < lines.size(); ++line) {
      canvas.text(left + pitch / 2.0, axes.bottom() + 3.0 + 2.6 * static_cast<double>(line), lines.at(line), kAxisText);
    }
  }
}

void draw_reaches(Canvas& canvas, double width, double height, const ChairData& chair) {
  const std::size_t targets = std::min(chair.targets.size(), kMostTargetsDrawn);
  if (targets == 0) return;
  std::vector<double> rises{0.0, 0.3};
  for (const ChairTrial& trial : chair.trials) {
    if (!trial.counts()) continue;
    rises.push_back(trial.reach()->features.d2_mm());
    rises.push_back(-trial.reach()->features.d1_mm());
  }
  const auto range = range_of(rises);
  if (!range) return;
  constexpr double kBetweenMm = 2.5;
  const double cell = (width - kAxisLeft - 1.0 - kBetweenMm * static_cast<double>(targets - 1)) / static_cast<double>(targets);
  for (std::size_t index = 0; index < targets; ++index) {
    const session::TargetSummary& target = chair.targets[index];
    const Axes axes{.left = kAxisLeft + (cell + kBetweenMm) * static_cast<double>(index),
                    .top = 6.0,
                    .width = cell,
                    .height = height - 6.0 - kAxisBottom,
                    .x_low = -kOverlayBeforeS,
                    .x_high = kOverlayAfterS,
                    .y_low = range->first,
                    .y_high = range->second};
    const auto trials = trials_to(chair, target);
    canvas.text(axes.left, 2.2, two_lines(target_text(chair, target.condition), cell)[0], {.size = kSmallText, .is_bold = true});
    canvas.text(axes.left, 4.8, "n = " + std::to_string(trials.size()), {.size = 1.9, .colour = colour::kDarkGrey});
    const Ticks ticks = round_ticks(axes.y_low, axes.y_high, 6);
    for (const double value : ticks.at) {
      canvas.line(axes.left, axes.y(value), axes.right(), axes.y(value), kGridStroke);
      if (index > 0) continue;
      canvas.text(axes.left - 0.8, axes.y(value) + 0.7, ticks.label(value),
                  {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
    }
    if (index == 0)
      canvas.text(axes.left - 8.0, axes.top + axes.height / 2.0, "change from P1, mm",
                  {.size = 2.4, .anchor = Anchor::Middle, .is_upward = true});
    draw_x_axis(canvas, axes, index == targets / 2 ? "time after P1, s" : "", 4);
    canvas.line(axes.left, axes.y(0.0), axes.right(), axes.y(0.0), {.colour = colour::kGrey, .width = 0.2});
    for (std::size_t k = 0; k < std::min(trials.size(), kMostOverlays); ++k) {
      const ChairTrial& trial = *trials[k];
      const double shift_s = trial.trace.begin_s - trial.after_cue_s(trial.reach()->p1.scan);
      const bool is_rejected = trial.movement() != nullptr && trial.movement()->trunk_class == TrunkClass::Rejected;
      draw_values(canvas, axes, trial.trace.smoothed(), shift_s, trial.trace.rate_hz, trial.reach()->features.p1_mm, kOverlayPoints,
                  {.colour = is_rejected ? colour::kVermillion : colour::kBlue, .width = 0.18});
    }
    canvas.rect(axes.left, axes.top, axes.width, axes.height, colour::kNone, kFrameStroke);
  }
}

}  // namespace dts::report
