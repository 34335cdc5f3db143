// SPDX-License-Identifier: Apache-2.0
#include "physics/sensor_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <tuple>
#include <utility>

namespace dts::physics {
namespace {

/// A curve is rejected if the probes of its tables, gap -> volts -> gap, are off by this much. Half of what sensor_curve.h promises,
/// because the largest error may lie between two probes.
constexpr double kLargestProbeErrorMm = 5e-5;
constexpr std::size_t kSmallestTable = 1024;
constexpr std::size_t kLargestTable = 65'536;

/// The smallest end slope, as a fraction of the first secant. The usual limit of 0 would make the inverse infinitely steep.
constexpr double kEndSlope = 0.25;

tl::unexpected<core::Error> bad_point(const std::string& name, std::size_t index, const CurvePoint& point, const std::string& why) {
  std::ostringstream message;
  message << "sensor curve '" << name << "', point " << index << " (" << point.gap.value << " mm, " << point.volts.value << " V): " << why;
  return core::fail(core::ErrorCode::InvalidArgument, message.str());
}

core::Status check_points(const std::string& name, const std::vector<CurvePoint>& points) {
  if (points.size() < 2) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "sensor curve '" + name + "' has " + std::to_string(points.size()) + " points, at least 2 are needed");
  }
  const bool is_rising = points[1].volts > points[0].volts;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!std::isfinite(points[k].gap.value) || !std::isfinite(points[k].volts.value)) {
      return bad_point(name, k, points[k], "not a finite number");
    }
    if (k == 0) continue;
    if (!(points[k].gap > points[k - 1].gap)) return bad_point(name, k, points[k], "the gap must be larger than that of the point before");
    const double step_v = points[k].volts.value - points[k - 1].volts.value;
    if (is_rising ? !(step_v > 0.0) : !(step_v < 0.0)) {
      return bad_point(name, k, points[k], "the volts must keep rising or keep falling, so that a voltage means one gap");
    }
  }
  return {};
}

/// Monotone piecewise cubic: F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17 (1980); interior slopes by the weighted
/// harmonic mean of Fritsch and Butland (1984).
class MonotoneCubic {
 public:
  explicit MonotoneCubic(const std::vector<CurvePoint>& points) : points_(points), slopes_(points.size()) {
    const std::size_t last = points.size() - 1;
    for (std::size_t k = 1; k < last; ++k) slopes_[k] = interior_slope(k);
    slopes_.front() = end_slope(0, last > 1 ? 1 : 0);
    slopes_.back() = end_slope(last - 1, last > 1 ? last - 2 : 0);
  }

  /// Volts at `gap` within segment `k`, which runs from point k to point k + 1.
  [[nodiscard]] double volts(std::size_t k, double gap) const noexcept {
    const double t = (gap - points_[k].gap.value) / width(k);
    const double u = 1.0 - t;
    return points_[k].volts.value * u * u * (1.0 + 2.0 * t) + points_[k + 1].volts.value * t * t * (1.0 + 2.0 * u) +
           width(k) * t * u * (slopes_[k] * u - slopes_[k + 1] * t);
  }

  /// Returns the gap of `volts_wanted` within segment `k`. Bisection: exact to the last digit for any slope.
  [[nodiscard]] double gap(std::size_t k, double volts_wanted) const noexcept {
    constexpr int kHalvings = 50;
    const bool is_rising = points_[1].volts > points_[0].volts;
    double low = points_[k].gap.value;
    double high = points_[k + 1].gap.value;
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (low + high);
      ((volts(k, middle) < volts_wanted) == is_rising ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

 private:
  [[nodiscard]] double width(std::size_t k) const noexcept { return points_[k + 1].gap.value - points_[k].gap.value; }
  [[nodiscard]] double secant(std::size_t k) const noexcept { return (points_[k + 1].volts.value - points_[k].volts.value) / width(k); }

  [[nodiscard]] double interior_slope(std::size_t k) const noexcept {
    const double before = width(k - 1);
    const double after = width(k);
    return 3.0 * (before + after) / ((2.0 * after + before) / secant(k - 1) + (after + 2.0 * before) / secant(k));
  }

  /// Three-point slope at the free end of segment `at`, limited so that the segment stays monotone.
  [[nodiscard]] double end_slope(std::size_t at, std::size_t next) const noexcept {
    const double slope = ((2.0 * width(at) + width(next)) * secant(at) - width(at) * secant(next)) / (width(at) + width(next));
    return secant(at) * std::clamp(slope / secant(at), kEndSlope, 3.0);
  }

  const std::vector<CurvePoint>& points_;
  std::vector<double> slopes_;
};

std::vector<double> tabulate_volts(const MonotoneCubic& cubic, const std::vector<CurvePoint>& points, std::size_t size) {
  const double first = points.front().gap.value;
  const double step = (points.back().gap.value - first) / static_cast<double>(size - 1);
  std::vector<double> table(size);
  std::size_t segment = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const double gap = first + step * static_cast<double>(k);
    while (segment + 2 < points.size() && gap > points[segment + 1].gap.value) ++segment;
    table[k] = cubic.volts(segment, gap);
  }
  table.back() = points.back().volts.value;
  return table;
}

/// Entry k is for the voltage k steps above the lowest one.
std::vector<double> tabulate_gaps(const MonotoneCubic& cubic, const std::vector<CurvePoint>& points, std::size_t size) {
  const double first = points.front().volts.value;
  const double step = (points.back().volts.value - first) / static_cast<double>(size - 1);
  std::vector<double> table(size);
  std::size_t segment = 0;
  for (std::size_t k = 1; k + 1 < size; ++k) {
    const double volts = first + step * static_cast<double>(k);
    while (segment + 2 < points.size() && (volts - points[segment + 1].volts.value) * step > 0.0) ++segment;
    table[k] = cubic.gap(segment, volts);
  }
  table.front() = points.front().gap.value;
  table.back() = points.back().gap.value;
  if (step < 0.0) std::reverse(table.begin(), table.end());
  return table;
}

/// Interpolates linearly in a table of even steps over [lowest, highest]; an argument outside counts as the end, NaN stays NaN.
double look_up(const std::vector<double>& table, double lowest, double highest, double argument) noexcept {
  const double last = static_cast<double>(table.size() - 1);
  const double position = (argument - lowest) * (last / (highest - lowest));
  if (!(position > 0.0)) return std::isnan(position) ? position : table.front();
  if (position >= last) return table.back();
  const auto k = static_cast<std::size_t>(position);
  return table[k] + (position - static_cast<double>(k)) * (table[k + 1] - table[k]);
}

}  // namespace

core::Result<SensorCurve> SensorCurve::create(std::string name, std::vector<CurvePoint> points) {
  DTS_TRY(check_points(name, points));
  SensorCurve curve;
  curve.name_ = std::move(name);
  curve.points_ = std::move(points);
  std::tie(curve.lowest_v_, curve.highest_v_) = std::minmax(curve.points_.front().volts.value, curve.points_.back().volts.value);
  const MonotoneCubic cubic(curve.points_);
  double error_mm = 0.0;
  for (std::size_t size = kSmallestTable; size <= kLargestTable; size *= 2) {
    curve.volts_table_ = tabulate_volts(cubic, curve.points_, size);
    curve.gap_table_ = tabulate_gaps(cubic, curve.points_, size);
    error_mm = curve.round_trip_error_mm();
    if (error_mm < kLargestProbeErrorMm) return curve;
  }
  std::ostringstream message;
  message << "sensor curve '" << curve.name_ << "' is nearly flat somewhere: gap to volts and back is off by " << error_mm << " mm, above "
          << kLargestProbeErrorMm << " mm";
  return core::fail(core::ErrorCode::InvalidArgument, message.str(), "leave out the flat end of the curve");
}

SensorCurve SensorCurve::hoa1405_assumed() {
  std::vector<CurvePoint> points;
  for (int quarter = 16; quarter <= 52; ++quarter) {
    const double gap = 0.25 * quarter;
    const double z = 12.0 - gap;
    points.push_back({{gap}, {0.9 + 0.35 * z + 0.058 * z * z}});
  }
  return *create("hoa1405-assumed", std::move(points));
}

core::Millimetres SensorCurve::minimum_gap() const noexcept { return points_.front().gap; }
core::Millimetres SensorCurve::maximum_gap() const noexcept { return points_.back().gap; }

core::Volts SensorCurve::volts(core::Millimetres gap) const noexcept {
  return {look_up(volts_table_, points_.front().gap.value, points_.back().gap.value, gap.value)};
}

core::Millimetres SensorCurve::gap(core::Volts volts) const noexcept { return {look_up(gap_table_, lowest_v_, highest_v_, volts.value)}; }

bool SensorCurve::contains(core::Volts volts) const noexcept { return volts.value >= lowest_v_ && volts.value <= highest_v_; }

double SensorCurve::round_trip_error_mm() const noexcept {
  // Both tables have their largest errors half way between entries; an odd number of probes per entry includes these places.
  const std::size_t probes = 3 * volts_table_.size() + 1;
  const double step = (maximum_gap() - minimum_gap()).value / static_cast<double>(probes);
  double largest = 0.0;
  for (std::size_t k = 0; k <= probes; ++k) {
    const core::Millimetres there{minimum_gap().value + step * static_cast<double>(k)};
    const double error = std::abs((gap(volts(there)) - there).value);
    if (!(error <= largest)) largest = error;  // keeps NaN: a curve of absurd numbers is rejected, too
  }
  return largest;
}

}  // namespace dts::physics
