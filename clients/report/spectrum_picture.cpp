// SPDX-License-Identifier: Apache-2.0
#include "report/spectrum_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "report/number_text.h"
#include "report/outline.h"

namespace dts::report {
namespace {

using posturography::Measure;
using posturography::Spectrum;

constexpr double kSpectrumLeft = 13.0;
constexpr double kSpectrumRight = 1.0;
constexpr double kSpectrumBottom = 7.5;
constexpr double kMostDecades = 6.0;
constexpr std::size_t kSpectrumMostPoints = 2000;

struct Plot {
  double left, top, width, height;
  double low, high;  ///< Decades: log10 of mm2/Hz.

  [[nodiscard]] double x(double hz) const {
    return left + width * std::log(hz / posturography::kBandLowHz) / std::log(posturography::kBandHighHz / posturography::kBandLowHz);
  }
  [[nodiscard]] double y(double density) const { return top + height * (high - std::clamp(std::log10(density), low, high)) / (high - low); }
};

struct Curve {
  const Spectrum& spectrum;
  Measure pf50;
  Measure pf95;
  std::string name;
  std::string_view colour;
  std::string_view dash;
};

void widen(const Spectrum& spectrum, double& least, double& most) {
  for (const double density : spectrum.density_mm2_per_hz) {
    if (!std::isfinite(density) || !(density > 0.0)) continue;
    least = std::min(least, density);
    most = std::max(most, density);
  }
}

std::string decade_label(int exponent) {
  if (exponent < -3 || exponent > 4) return "1e" + std::to_string(exponent);
  return fixed(std::pow(10.0, exponent), std::max(0, -exponent));
}

void draw_axes(Canvas& canvas, const Plot& plot) {
  const double bottom = plot.top + plot.height;
  for (const double hz : {0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    canvas.line(plot.x(hz), plot.top, plot.x(hz), bottom, {.colour = colour::kGrid, .width = 0.15});
  }
  constexpr std::array<std::pair<double, const char*>, 8> kLabels{
      {{0.15, "0.15"}, {0.2, "0.2"}, {0.3, "0.3"}, {0.5, "0.5"}, {1.0, "1"}, {2.0, "2"}, {3.0, "3"}, {5.0, "5"}}};
  for (const auto& [hz, label] : kLabels) {
    canvas.text(plot.x(hz), bottom + 2.8, label, {.size = kSmallText, .anchor = Anchor::Middle, .colour = colour::kDarkGrey});
  }
  for (int exponent = static_cast<int>(plot.low); exponent <= static_cast<int>(plot.high); ++exponent) {
    const double y = plot.top + plot.height * (plot.high - exponent) / (plot.high - plot.low);
    canvas.line(plot.left, y, plot.left + plot.width, y, {.colour = colour::kGrid, .width = 0.15});
    canvas.text(plot.left - 0.8, y + 0.7, decade_label(exponent), {.size = kSmallText, .anchor = Anchor::End, .colour = colour::kDarkGrey});
  }
  canvas.rect(plot.left, plot.top, plot.width, plot.height, colour::kNone, {.colour = colour::kGrey, .width = 0.2});
  canvas.text(plot.left + plot.width / 2.0, bottom + 6.0, "frequency, Hz", {.size = 2.4, .anchor = Anchor::Middle});
  canvas.text(plot.left - 10.0, plot.top + plot.height / 2.0, "density, mm2/Hz",
              {.size = 2.4, .anchor = Anchor::Middle, .is_upward = true});
}

std::optional<double> density_at(const Spectrum& spectrum, double hz) {
  if (!(spectrum.bin_hz > 0.0)) return std::nullopt;
  const double place = std::round(hz / spectrum.bin_hz) - static_cast<double>(spectrum.first_bin);
  if (!(place >= 0.0) || place >= static_cast<double>(spectrum.density_mm2_per_hz.size())) return std::nullopt;
  const double density = spectrum.density_mm2_per_hz[static_cast<std::size_t>(place)];
  return density > 0.0 ? std::optional(density) : std::nullopt;
}

void draw_curve(Canvas& canvas, const Plot& plot, const Curve& curve) {
  const auto& densities = curve.spectrum.density_mm2_per_hz;
  std::vector<PlotPoint> points;
  for (const std::size_t index : thinned(densities, densities, kSpectrumMostPoints)) {
    if (densities[index] > 0.0) points.push_back({.x = plot.x(curve.spectrum.frequency_hz(index)), .y = plot.y(densities[index])});
  }
  canvas.path(path_data(points), {.colour = curve.colour, .width = 0.35, .dash = curve.dash});
}

/// Draws PF50 as a full dot and PF95 as a ring. Their values are in the legend, where they cannot overlap.
void draw_quantiles(Canvas& canvas, const Plot& plot, const Curve& curve, const posturography::Measures& measures, double legend_y) {
  const auto pf50 = measures.get(curve.pf50);
  const auto pf95 = measures.get(curve.pf95);
  const auto mark = [&](const std::optional<double>& hz, std::string_view fill) {
    const auto density = hz ? density_at(curve.spectrum, *hz) : std::nullopt;
    if (density) canvas.circle(plot.x(*hz), plot.y(*density), 0.9, fill, {.colour = curve.colour, .width = 0.4});
  };
  mark(pf50, curve.colour);
  mark(pf95, "#FFFFFF");
  const double x = plot.left + 2.0;
  canvas.line(x, legend_y - 0.7, x + 6.0, legend_y - 0.7, {.colour = curve.colour, .width = 0.35, .dash = curve.dash});
  canvas.text(x + 7.0, legend_y, curve.name, {.size = kSmallText, .colour = curve.colour, .is_bold = true});
  if (!pf50 || !pf95) return;
  canvas.circle(x + 13.2, legend_y - 0.7, 0.8, curve.colour, {.colour = curve.colour, .width = 0.3});
  canvas.text(x + 14.8, legend_y, "PF50 " + fixed(*pf50, 3) + " Hz", {.size = kSmallText});
  canvas.circle(x + 36.0, legend_y - 0.7, 0.8, "#FFFFFF", {.colour = curve.colour, .width = 0.4});
  canvas.text(x + 37.6, legend_y, "PF95 " + fixed(*pf95, 3) + " Hz", {.size = kSmallText});
}

}  // namespace

void draw_spectra(Canvas& canvas, double width, double height, const posturography::Spectra& spectra,
                  const posturography::Measures& measures, const std::string& why_not) {
  double least = 1e300;
  double most = 0.0;
  widen(spectra.ap, least, most);
  widen(spectra.ml, least, most);
  if (!(most > 0.0)) {
    canvas.text(width / 2.0, height / 2.0, "no spectrum: " + why_not, {.anchor = Anchor::Middle, .colour = colour::kDarkGrey});
    return;
  }
  Plot plot{.left = kSpectrumLeft,
            .top = 1.5,
            .width = width - kSpectrumLeft - kSpectrumRight,
            .height = height - kSpectrumBottom - 1.5,
            .low = 0.0,
            .high = 0.0};
  plot.high = std::ceil(std::log10(most));
  plot.low = std::max(std::floor(std::log10(least)), plot.high - kMostDecades);
  if (plot.low >= plot.high) plot.low = plot.high - 1.0;
  const Curve ap{spectra.ap, Measure::Pf50Ap, Measure::Pf95Ap, "AP", colour::kBlue, ""};
  const Curve ml{spectra.ml, Measure::Pf50Ml, Measure::Pf95Ml, "ML", colour::kVermillion, "1.6 0.7"};
  draw_axes(canvas, plot);
  draw_curve(canvas, plot, ap);
  draw_curve(canvas, plot, ml);
  draw_quantiles(canvas, plot, ap, measures, plot.top + plot.height - 5.0);
  draw_quantiles(canvas, plot, ml, measures, plot.top + plot.height - 2.0);
}

}  // namespace dts::report
