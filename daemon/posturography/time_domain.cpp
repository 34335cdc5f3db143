// SPDX-License-Identifier: Apache-2.0
#include "posturography/time_domain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "posturography/convex_hull.h"
#include "posturography/ellipse.h"

namespace dts::posturography {
namespace {

using std::numbers::pi;

constexpr double kOneSided95 = 1.645;               // Prieto's z of the 95 % circle
constexpr double kEllipseF = 3.00;                  // Prieto's F of the 95 % ellipse: for many samples
constexpr double kChiSquare95 = 5.991464547107982;  // -2 ln 0.05
/// If the variances differ by less than this fraction, the ellipse has no direction: the difference is rounding.
constexpr double kRound = 1e-12;

/// Statistics of the distances from the mean position.
struct Distances {
  double mean = 0.0;
  double rms = 0.0;
  double largest = 0.0;
  double spread = 0.0;  ///< Population standard deviation: sqrt(rms^2 - mean^2), but computed without loss of digits on a circle.

  /// Radius of Prieto's 95 % confidence circle.
  [[nodiscard]] double circle_radius() const noexcept { return mean + kOneSided95 * spread; }
};

template <class DistanceAt>
Distances distances(std::size_t count, DistanceAt distance_at) {
  double sum = 0.0;
  double squares = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double distance = distance_at(i);
    sum += distance;
    squares += distance * distance;
    largest = std::max(largest, distance);
  }
  const auto n = static_cast<double>(count);
  const double mean = sum / n;
  double deviations = 0.0;
  for (std::size_t i = 0; i < count; ++i) deviations += (distance_at(i) - mean) * (distance_at(i) - mean);
  return {.mean = mean, .rms = std::sqrt(squares / n), .largest = largest, .spread = std::sqrt(deviations / n)};
}

struct ThreeDistances {
  Distances planar;
  Distances ap;
  Distances ml;
};

ThreeDistances distances_of(const Prepared& cop) {
  const auto& ap = cop.ap_mm;
  const auto& ml = cop.ml_mm;
  return {.planar = distances(cop.size(), [&](std::size_t i) { return std::hypot(ap[i], ml[i]); }),
          .ap = distances(cop.size(), [&](std::size_t i) { return std::abs(ap[i]); }),
          .ml = distances(cop.size(), [&](std::size_t i) { return std::abs(ml[i]); })};
}

struct Path {
  double planar_mm = 0.0;
  double ap_mm = 0.0;
  double ml_mm = 0.0;
  double swept_mm2 = 0.0;  ///< Around the mean position, in either direction.
};

Path path_of(const Prepared& cop) {
  Path path;
  for (std::size_t i = 0; i + 1 < cop.size(); ++i) {
    const double ap_step = cop.ap_mm[i + 1] - cop.ap_mm[i];
    const double ml_step = cop.ml_mm[i + 1] - cop.ml_mm[i];
    path.planar_mm += std::hypot(ap_step, ml_step);
    path.ap_mm += std::abs(ap_step);
    path.ml_mm += std::abs(ml_step);
    path.swept_mm2 += 0.5 * std::abs(cop.ap_mm[i + 1] * cop.ml_mm[i] - cop.ap_mm[i] * cop.ml_mm[i + 1]);
  }
  return path;
}

/// Sums of products of the centred columns over N - 1.
Covariance sample_covariance(const Prepared& cop) {
  Covariance sums;
  for (std::size_t i = 0; i < cop.size(); ++i) {
    sums.ml_ml += cop.ml_mm[i] * cop.ml_mm[i];
    sums.ml_ap += cop.ml_mm[i] * cop.ap_mm[i];
    sums.ap_ap += cop.ap_mm[i] * cop.ap_mm[i];
  }
  const double n1 = static_cast<double>(cop.size()) - 1.0;
  return {.ml_ml = sums.ml_ml / n1, .ml_ap = sums.ml_ap / n1, .ap_ap = sums.ap_ap / n1};
}

void add_distances(const ThreeDistances& of_axes, Measures& measures) {
  const auto add = [&](Axis axis, const Distances& distances) {
    measures.set(of(Measure::Mdist, axis), distances.mean);
    measures.set(of(Measure::Rdist, axis), distances.rms);
    measures.set(of(Measure::Maxdist, axis), distances.largest);
  };
  add(Axis::Planar, of_axes.planar);
  add(Axis::Ap, of_axes.ap);
  add(Axis::Ml, of_axes.ml);
}

void add_path(const Path& path, double duration_s, Measures& measures) {
  const auto add = [&](Axis axis, double length_mm) {
    measures.set(of(Measure::Totex, axis), length_mm);
    measures.set(of(Measure::Mvelo, axis), length_mm / duration_s);
  };
  add(Axis::Planar, path.planar_mm);
  add(Axis::Ap, path.ap_mm);
  add(Axis::Ml, path.ml_mm);
  measures.set(Measure::AreaSw, path.swept_mm2 / duration_s);
}

void add_extent(const Prepared& cop, Measures& measures) {
  const auto range = [](std::span<const double> values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return *most - *least;
  };
  measures.set(Measure::RangeAp, range(cop.ap_mm));
  measures.set(Measure::RangeMl, range(cop.ml_mm));
  const std::vector<Point> hull = convex_hull(cop.ml_mm, cop.ap_mm);
  measures.set(Measure::Range, diameter_mm(hull));
  measures.set(Measure::AreaHull, area_mm2(hull));
}

void add_ellipse(const PredictionEllipse& ellipse, Measures& measures) {
  const double root_of_determinant = ellipse.sd1_mm * ellipse.sd2_mm;
  measures.set(Measure::Pea95F, ellipse.area_mm2);
  measures.set(Measure::Pea95Chi2, pi * kChiSquare95 * root_of_determinant);
  measures.set(Measure::EllSd1, ellipse.sd1_mm);
  measures.set(Measure::EllSd2, ellipse.sd2_mm);
  const double larger = ellipse.sd1_mm * ellipse.sd1_mm;
  if (larger - ellipse.sd2_mm * ellipse.sd2_mm > kRound * larger) measures.set(Measure::EllAngle, ellipse.angle_deg);
}

/// Adds Katz' dimension with the extent `extent_mm`: ln N / ln(N d / TOTEX). Undefined if the path does not move or is longer than N
/// extents, as for a point that jumps to and fro with every sample: the formula is then infinite or negative.
void add_fractal_dimension(Measure measure, std::size_t samples, double extent_mm, double path_mm, Measures& measures) {
  const auto n = static_cast<double>(samples);
  if (path_mm > 0.0 && extent_mm > 0.0 && n * extent_mm > path_mm) measures.set(measure, std::log(n) / std::log(n * extent_mm / path_mm));
}

void add_mean_frequencies(const ThreeDistances& of_axes, const Path& path, double duration_s, Measures& measures) {
  const auto add = [&](Measure measure, double length_mm, double turn_mm) {
    if (turn_mm > 0.0) measures.set(measure, length_mm / (turn_mm * duration_s));
  };
  add(Measure::Mfreq, path.planar_mm, 2.0 * pi * of_axes.planar.mean);
  add(Measure::MfreqAp, path.ap_mm, 4.0 * std::numbers::sqrt2 * of_axes.ap.mean);
  add(Measure::MfreqMl, path.ml_mm, 4.0 * std::numbers::sqrt2 * of_axes.ml.mean);
}

}  // namespace

void add_time_domain(const Prepared& prepared, Measures& measures) {
  const std::size_t samples = prepared.size();
  if (samples < 2 || prepared.ap_mm.size() != samples || !(prepared.rate_hz > 0.0)) return;
  const double duration_s = prepared.duration_s();
  const ThreeDistances of_axes = distances_of(prepared);
  const Path path = path_of(prepared);
  add_distances(of_axes, measures);
  add_path(path, duration_s, measures);
  add_extent(prepared, measures);
  add_mean_frequencies(of_axes, path, duration_s, measures);

  const double radius_mm = of_axes.planar.circle_radius();
  measures.set(Measure::AreaCc, pi * radius_mm * radius_mm);
  add_fractal_dimension(Measure::FdCc, samples, 2.0 * radius_mm, path.planar_mm, measures);

  const Covariance covariance = sample_covariance(prepared);
  measures.set(Measure::Sd1Ap, std::sqrt(covariance.ap_ap));
  measures.set(Measure::Sd1Ml, std::sqrt(covariance.ml_ml));
  const auto ellipse = prediction_ellipse(covariance, samples);
  if (!ellipse) return;
  add_ellipse(*ellipse, measures);
  const auto n = static_cast<double>(samples);
  // Prieto's own ellipse uses the covariance over N.
  const double root_of_determinant = ellipse->sd1_mm * ellipse->sd2_mm * (n - 1.0) / n;
  measures.set(Measure::AreaCe, 2.0 * pi * kEllipseF * root_of_determinant);
  add_fractal_dimension(Measure::FdCe, samples, std::sqrt(8.0 * kEllipseF * root_of_determinant), path.planar_mm, measures);
  if (ellipse->area_mm2 > 0.0) measures.set(Measure::Lfs, path.planar_mm / ellipse->area_mm2);
}

}  // namespace dts::posturography
