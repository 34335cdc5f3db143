// SPDX-License-Identifier: Apache-2.0
#include "report/stabilogram.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "report/number_text.h"
#include "report/outline.h"
#include "report/ticks.h"

namespace dts::report {
namespace {

using posturography::Prepared;

constexpr std::size_t kPathMostPoints = 6000;
constexpr double kRoom = 1.06;  // space between the data and the frame
constexpr double kPathLeft = 10.0;
constexpr double kPathRight = 23.0;  // space for inset and legend with any font
constexpr double kTop = 1.0;
constexpr double kPathBottom = 8.5;

/// Where the path is drawn, and its scale.
struct Frame {
  double left, top, width, height;
  double paper_per_mm;

  [[nodiscard]] double x(double ml_mm) const { return left + width / 2.0 + ml_mm * paper_per_mm; }
  [[nodiscard]] double y(double ap_mm) const { return top + height / 2.0 - ap_mm * paper_per_mm; }
  [[nodiscard]] double half_ml_mm() const { return width / 2.0 / paper_per_mm; }
  [[nodiscard]] double half_ap_mm() const { return height / 2.0 / paper_per_mm; }
};

void draw_grid(Canvas& canvas, const Frame& frame) {
  const double half_mm = std::max(frame.half_ml_mm(), frame.half_ap_mm());
  const Ticks all = round_ticks(-half_mm, half_mm, 9);
  const double bottom = frame.top + frame.height;
  const TextStyle number{.size = kSmallText, .anchor = Anchor::Middle, .colour = colour::kDarkGrey};
  for (const double mm : all.at) {
    const Stroke stroke{.colour = std::abs(mm) < all.step / 2.0 ? colour::kGrey : colour::kGrid, .width = 0.15};
    if (std::abs(mm) <= frame.half_ml_mm()) {
      canvas.line(frame.x(mm), frame.top, frame.x(mm), bottom, stroke);
      canvas.text(frame.x(mm), bottom + 2.8, all.label(mm), number);
    }
    if (std::abs(mm) <= frame.half_ap_mm()) {
      canvas.line(frame.left, frame.y(mm), frame.left + frame.width, frame.y(mm), stroke);
      canvas.text(frame.left - 0.8, frame.y(mm) + 0.7, all.label(mm),
                  {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
    }
  }
  canvas.rect(frame.left, frame.top, frame.width, frame.height, colour::kNone, {.colour = colour::kGrey, .width = 0.2});
}

void draw_axis_titles(Canvas& canvas, const Frame& frame) {
  const double below = frame.top + frame.height + 6.4;
  const double beside = frame.left - 7.4;
  const TextStyle word{.size = kSmallText, .colour = colour::kDarkGrey};
  canvas.text(frame.left, below, "left", word);
  canvas.text(frame.left + frame.width / 2.0, below, "ML, mm", {.size = 2.4, .anchor = Anchor::Middle});
  canvas.text(frame.left + frame.width, below, "right", {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
  canvas.text(beside, frame.top + frame.height, "back", {.size = kSmallText, .colour = colour::kDarkGrey, .is_upward = true});
  canvas.text(beside, frame.top + frame.height / 2.0, "AP, mm", {.size = 2.4, .anchor = Anchor::Middle, .is_upward = true});
  canvas.text(beside, frame.top, "front", {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey, .is_upward = true});
}

void draw_scale_bar(Canvas& canvas, const Frame& frame) {
  const Ticks lengths = round_ticks(0.0, 0.6 * frame.half_ml_mm(), 2);
  const double length_mm = lengths.step;
  const double length = length_mm * frame.paper_per_mm;
  const double right = frame.left + frame.width - 2.0;
  const double y = frame.top + frame.height - 2.5;
  const Stroke stroke{.width = 0.5};
  canvas.rect(right - length - 1.0, y - 3.4, length + 2.0, 4.6, "#FFFFFF", {.colour = colour::kNone});
  canvas.line(right - length, y, right, y, stroke);
  canvas.line(right - length, y - 0.7, right - length, y + 0.7, stroke);
  canvas.line(right, y - 0.7, right, y + 0.7, stroke);
  canvas.text(right - length / 2.0, y - 1.1, lengths.label(length_mm) + " mm", {.size = kSmallText, .anchor = Anchor::Middle});
}

/// Draws the plate from above with the frame of the picture; the plate's centre is the origin of the recorded COP.
void draw_inset(Canvas& canvas, double x, double y, double size, const Frame& frame, const Prepared& prepared, const PlateSize& plate) {
  const double scale = size / std::max(plate.a_mm, plate.b_mm);
  const double width = plate.a_mm * scale;
  const double height = plate.b_mm * scale;
  canvas.rect(x, y, width, height, colour::kShade, {.colour = colour::kGrey, .width = 0.2});
  const double centre_x = x + width / 2.0;
  const double centre_y = y + height / 2.0;
  canvas.line(centre_x - 1.0, centre_y, centre_x + 1.0, centre_y, {.colour = colour::kGrey, .width = 0.15});
  canvas.line(centre_x, centre_y - 1.0, centre_x, centre_y + 1.0, {.colour = colour::kGrey, .width = 0.15});
  const double left = std::clamp(centre_x + (prepared.mean_ml_mm - frame.half_ml_mm()) * scale, x, x + width);
  const double right = std::clamp(centre_x + (prepared.mean_ml_mm + frame.half_ml_mm()) * scale, x, x + width);
  const double top = std::clamp(centre_y - (prepared.mean_ap_mm + frame.half_ap_mm()) * scale, y, y + height);
  const double bottom = std::clamp(centre_y - (prepared.mean_ap_mm - frame.half_ap_mm()) * scale, y, y + height);
  canvas.rect(left, top, std::max(right - left, 0.3), std::max(bottom - top, 0.3), colour::kNone, {.colour = colour::kBlue, .width = 0.35});
  const TextStyle style{.size = kSmallText, .colour = colour::kDarkGrey};
  canvas.text(x, y + height + 2.8, "drawn area on", style);
  canvas.text(x, y + height + 5.4, "plate, " + fixed(plate.a_mm, 0) + " x", style);
  canvas.text(x, y + height + 8.0, fixed(plate.b_mm, 0) + " mm, front up", style);
}

void draw_legend(Canvas& canvas, double x, double y, const Frame& frame, const Prepared& prepared,
                 const std::optional<EllipseOutline>& ellipse) {
  const TextStyle small{.size = kSmallText, .colour = colour::kDarkGrey};
  const auto line = [&](const std::string& text) {
    canvas.text(x, y, text, small);
    y += 2.7;
  };
  canvas.line(x, y - 0.7, x + 5.0, y - 0.7, {.colour = colour::kBlue, .width = 0.3});
  canvas.text(x + 6.0, y, "COP path", small);
  y += 3.6;
  if (ellipse) {
    canvas.line(x, y - 0.7, x + 5.0, y - 0.7, {.colour = colour::kVermillion, .width = 0.5});
    canvas.text(x + 6.0, y, "95 %", small);
    y += 2.7;
    line("prediction");
    line("ellipse, semi-axes");
    line(significant(ellipse->semi_major_mm) + " mm,");
    line(significant(ellipse->semi_minor_mm) + " mm,");
    line("major axis " + fixed(ellipse->angle_deg, 1));
    line("deg from ML");
    y += 0.9;
  }
  canvas.line(x + 1.5, y - 0.7, x + 3.5, y - 0.7, {.width = 0.4});
  canvas.line(x + 2.5, y - 1.7, x + 2.5, y + 0.3, {.width = 0.4});
  canvas.text(x + 6.0, y, "mean, from", small);
  y += 2.7;
  line("the plate's centre:");
  line("ML " + fixed(prepared.mean_ml_mm, 1) + " mm");
  line("AP " + fixed(prepared.mean_ap_mm, 1) + " mm");
  y += 0.9;
  line(fixed(frame.paper_per_mm, 2) + " x life size");
  line("on A4");
}

}  // namespace

std::optional<EllipseOutline> ellipse_outline(const Prepared& prepared) {
  if (prepared.size() < 3) return std::nullopt;
  posturography::Covariance covariance;
  for (std::size_t index = 0; index < prepared.size(); ++index) {
    covariance.ml_ml += prepared.ml_mm[index] * prepared.ml_mm[index];
    covariance.ml_ap += prepared.ml_mm[index] * prepared.ap_mm[index];
    covariance.ap_ap += prepared.ap_mm[index] * prepared.ap_mm[index];
  }
  const double freedom = static_cast<double>(prepared.size() - 1);
  covariance = {.ml_ml = covariance.ml_ml / freedom, .ml_ap = covariance.ml_ap / freedom, .ap_ap = covariance.ap_ap / freedom};
  const auto found = posturography::prediction_ellipse(covariance, prepared.size());
  if (!found) return std::nullopt;
  const double axis = std::sqrt(found->factor);
  return EllipseOutline{.semi_major_mm = axis * found->sd1_mm,
                        .semi_minor_mm = axis * found->sd2_mm,
                        .angle_deg = found->angle_deg,
                        .area_mm2 = found->area_mm2};
}

HalfExtent half_extent(const Prepared& prepared, const std::optional<EllipseOutline>& ellipse) {
  HalfExtent half;
  for (const double mm : prepared.ml_mm) half.ml_mm = std::max(half.ml_mm, std::abs(mm));
  for (const double mm : prepared.ap_mm) half.ap_mm = std::max(half.ap_mm, std::abs(mm));
  if (!ellipse) return half;
  const double angle = ellipse->angle_deg * std::numbers::pi / 180.0;
  half.ml_mm = std::max(half.ml_mm, std::hypot(ellipse->semi_major_mm * std::cos(angle), ellipse->semi_minor_mm * std::sin(angle)));
  half.ap_mm = std::max(half.ap_mm, std::hypot(ellipse->semi_major_mm * std::sin(angle), ellipse->semi_minor_mm * std::cos(angle)));
  return half;
}

void draw_path(Canvas& canvas, double x, double y, double paper_per_mm, const Prepared& prepared, std::size_t most_points,
               double line_width) {
  std::vector<PlotPoint> points;
  for (const std::size_t index : thinned(prepared.ml_mm, prepared.ap_mm, most_points)) {
    points.push_back({.x = x + prepared.ml_mm[index] * paper_per_mm, .y = y - prepared.ap_mm[index] * paper_per_mm});
  }
  canvas.path(path_data(points), {.colour = colour::kBlue, .width = line_width});
  if (const auto ellipse = ellipse_outline(prepared)) {
    const double major = ellipse->semi_major_mm * paper_per_mm;
    const double minor = ellipse->semi_minor_mm * paper_per_mm;
    canvas.ellipse(x, y, major, minor, ellipse->angle_deg, {.colour = colour::kVermillion, .width = 2.0 * line_width});
    const double angle = ellipse->angle_deg * std::numbers::pi / 180.0;
    const Stroke axis{.colour = colour::kVermillion, .width = line_width, .dash = "1.2 0.8"};
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    canvas.line(x - major * c, y + major * s, x + major * c, y - major * s, axis);
    canvas.line(x - minor * s, y - minor * c, x + minor * s, y + minor * c, axis);
  }
  const double arm = 1.0;
  canvas.line(x - arm, y, x + arm, y, {.width = 0.4});
  canvas.line(x, y - arm, x, y + arm, {.width = 0.4});
}

void draw_stabilogram(Canvas& canvas, double width, double height, const Prepared& prepared, const std::optional<PlateSize>& plate) {
  Frame frame{
      .left = kPathLeft, .top = kTop, .width = width - kPathLeft - kPathRight, .height = height - kTop - kPathBottom, .paper_per_mm = 1.0};
  const auto ellipse = ellipse_outline(prepared);
  const HalfExtent half = half_extent(prepared, ellipse);
  frame.paper_per_mm = std::min(frame.width / (2.0 * kRoom * half.ml_mm), frame.height / (2.0 * kRoom * half.ap_mm));
  draw_grid(canvas, frame);
  draw_path(canvas, frame.x(0.0), frame.y(0.0), frame.paper_per_mm, prepared, kPathMostPoints, 0.18);
  draw_scale_bar(canvas, frame);
  draw_axis_titles(canvas, frame);
  const double beside = frame.left + frame.width + 2.0;
  double below = frame.top + 2.0;
  if (plate) {
    const double size = kPathRight - 7.0;
    draw_inset(canvas, beside, frame.top, size, frame, prepared, *plate);
    below += size * plate->b_mm / std::max(plate->a_mm, plate->b_mm) + 11.0;
  }
  draw_legend(canvas, beside, below, frame, prepared, ellipse);
}

}  // namespace dts::report
