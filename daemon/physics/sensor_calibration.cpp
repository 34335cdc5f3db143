// SPDX-License-Identifier: Apache-2.0
#include "physics/sensor_calibration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace dts::physics {
namespace {

constexpr double kSameGapMm = 1e-3;
constexpr std::size_t kGapsForCubic = 6;
constexpr double kCubicErrorOfSpan = 0.005;      // largest difference between a smooth sensor curve and a cubic
constexpr double kQuadraticErrorOfSpan = 0.015;  // the same for a quadratic
constexpr double kRepeatFloorOfSpan = 0.002;     // a spacer is never put back to exactly the same position
constexpr double kMadToDeviation = 1.4826;       // for a normal distribution
constexpr double kMostScatterOfSpan = 0.05;      // a larger scatter, with any one point left out, is not a curve

/// All readings of one gap.
struct Level {
  double gap_mm = 0.0;
  double mean_v = 0.0;
  double median_v = 0.0;
  std::vector<GapReading> readings;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

template <class... Numbers>
std::string text(const char* format, Numbers... numbers) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, numbers...);
  return buffer;
}

tl::unexpected<core::Error> refuse(const GapReading& reading, const std::string& why, double low_v, double high_v, std::string hint) {
  return core::fail(core::ErrorCode::InvalidArgument,
                    "row " + std::to_string(reading.row) + text(" (gap %g mm, %.4f V): ", reading.gap.value, reading.volts.value) + why +
                        text("; expected %.4f .. %.4f V", std::min(low_v, high_v), std::max(low_v, high_v)),
                    std::move(hint));
}

core::Result<std::vector<Level>> sort_into_levels(std::span<const GapReading> readings) {
  std::vector<GapReading> sorted(readings.begin(), readings.end());
  for (const GapReading& reading : sorted) {
    if (std::isfinite(reading.gap.value) && std::isfinite(reading.volts.value)) continue;
    return core::fail(core::ErrorCode::InvalidArgument, "row " + std::to_string(reading.row) + " is not a finite number");
  }
  std::ranges::stable_sort(sorted, {}, [](const GapReading& reading) { return reading.gap.value; });
  std::vector<Level> levels;
  for (const GapReading& reading : sorted) {
    if (levels.empty() || reading.gap.value - levels.back().gap_mm > kSameGapMm) levels.push_back({.gap_mm = reading.gap.value});
    levels.back().readings.push_back(reading);
  }
  for (Level& level : levels) {
    std::vector<double> volts;
    for (const GapReading& reading : level.readings) volts.push_back(reading.volts.value);
    level.median_v = median(volts);
    for (const double value : volts) level.mean_v += value / static_cast<double>(volts.size());
  }
  if (levels.size() >= kLeastGaps) return levels;
  return core::fail(core::ErrorCode::InvalidArgument,
                    std::to_string(levels.size()) + " different gaps, at least " + std::to_string(kLeastGaps) + " are needed",
                    "measure more gaps over the working range of the sensor");
}

double span_v(const std::vector<Level>& levels) {
  const auto [low, high] = std::ranges::minmax_element(levels, {}, &Level::median_v);
  return high->median_v - low->median_v;
}

core::Status check_repeats(const std::vector<Level>& levels) {
  std::vector<double> deviations_v;
  for (const Level& level : levels) {
    if (level.readings.size() < 2) continue;
    for (const GapReading& reading : level.readings) deviations_v.push_back(std::abs(reading.volts.value - level.median_v));
  }
  if (deviations_v.empty()) return {};
  const double tolerance_v = kTolerance * std::max(kMadToDeviation * median(deviations_v), kRepeatFloorOfSpan * span_v(levels));
  for (const Level& level : levels) {
    for (const GapReading& reading : level.readings) {
      if (std::abs(reading.volts.value - level.median_v) <= tolerance_v) continue;
      return refuse(reading, "it differs from the other readings of this gap", level.median_v - tolerance_v, level.median_v + tolerance_v,
                    "measure this gap again, or leave the row out");
    }
  }
  return {};
}

/// A polynomial through all levels except one.
struct Fit {
  double scatter_v = 0.0;         ///< Of the used levels, per degree of freedom.
  double prediction_v = 0.0;      ///< At the omitted level.
  double prediction_error = 0.0;  ///< Of the difference at the omitted level, in units of one level's error: sqrt(1 + leverage).
};

/// Returns rows of Legendre-like powers of the gap scaled to -1 .. 1: well conditioned for these low degrees.
Eigen::VectorXd basis(const std::vector<Level>& levels, double gap_mm, int degree) {
  const double first = levels.front().gap_mm;
  const double last = levels.back().gap_mm;
  const double x = (2.0 * gap_mm - first - last) / (last - first);
  Eigen::VectorXd row(degree + 1);
  for (int k = 0; k <= degree; ++k) row(k) = k == 0 ? 1.0 : row(k - 1) * x;
  return row;
}

Fit fit_without(const std::vector<Level>& levels, std::size_t left_out, int degree) {
  const auto count = static_cast<Eigen::Index>(levels.size()) - (left_out < levels.size() ? 1 : 0);
  Eigen::MatrixXd matrix(count, degree + 1);
  Eigen::VectorXd volts(count);
  Eigen::Index next = 0;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (k == left_out) continue;
    matrix.row(next) = basis(levels, levels[k].gap_mm, degree);
    volts(next++) = levels[k].mean_v;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::VectorXd coefficients = qr.solve(volts);
  Fit fit;
  fit.scatter_v = (volts - matrix * coefficients).norm() / std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, count - degree - 1)));
  if (left_out >= levels.size()) return fit;
  const Eigen::VectorXd there = basis(levels, levels[left_out].gap_mm, degree);
  fit.prediction_v = there.dot(coefficients);
  const Eigen::VectorXd solved = (matrix.transpose() * matrix).ldlt().solve(there);
  fit.prediction_error = std::sqrt(1.0 + there.dot(solved));
  return fit;
}

int degree_for(const std::vector<Level>& levels) { return levels.size() >= kGapsForCubic ? 3 : 2; }

core::Status check_smoothness(const std::vector<Level>& levels) {
  const int degree = degree_for(levels);
  const double floor_v = (degree == 3 ? kCubicErrorOfSpan : kQuadraticErrorOfSpan) * span_v(levels);
  std::size_t suspect = 0;
  Fit best = fit_without(levels, 0, degree);
  for (std::size_t k = 1; k < levels.size(); ++k) {
    const Fit fit = fit_without(levels, k, degree);
    if (fit.scatter_v < best.scatter_v) {
      best = fit;
      suspect = k;
    }
  }
  if (best.scatter_v > kMostScatterOfSpan * span_v(levels)) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      text("the readings scatter by %.4f V about any smooth curve, even with one gap left out", best.scatter_v),
                      "several rows are wrong: check that gaps and volts are in the right columns and the spacers in the right order");
  }
  const double tolerance_v = kTolerance * std::max(floor_v, best.scatter_v) * best.prediction_error;
  const Level& level = levels[suspect];
  if (std::abs(level.mean_v - best.prediction_v) <= tolerance_v) return {};
  return refuse(level.readings.front(), "it is off the smooth curve through the other gaps", best.prediction_v - tolerance_v,
                best.prediction_v + tolerance_v, "measure this gap again; check that it is the right spacer");
}

core::Status check_monotony(const std::vector<Level>& levels) {
  const double direction = levels.back().mean_v > levels.front().mean_v ? 1.0 : -1.0;
  for (std::size_t k = 1; k < levels.size(); ++k) {
    if (direction * (levels[k].mean_v - levels[k - 1].mean_v) > 0.0) continue;
    const double beyond_v = k + 1 < levels.size() ? levels[k + 1].mean_v : levels[k - 1].mean_v + direction * span_v(levels);
    return refuse(
        levels[k].readings.front(),
        text("with the gap %g mm before it the voltage does not keep %s", levels[k - 1].gap_mm, direction > 0.0 ? "rising" : "falling"),
        levels[k - 1].mean_v, beyond_v, "a voltage must mean one gap: leave out the gaps beyond the sensor's peak, or measure again");
  }
  return {};
}

}  // namespace

core::Result<SensorCalibration> calibrate_sensor(std::span<const GapReading> readings) {
  DTS_TRY_ASSIGN(const auto levels, sort_into_levels(readings));
  for (const auto& check : {check_repeats, check_smoothness, check_monotony}) {
    DTS_TRY(check(levels));
  }
  SensorCalibration calibration;
  calibration.least_readings = levels.front().readings.size();
  calibration.residual_v = fit_without(levels, levels.size(), degree_for(levels)).scatter_v;
  double squares = 0.0;
  for (const Level& level : levels) {
    calibration.points.push_back({.gap = {level.gap_mm}, .volts = {level.mean_v}});
    calibration.least_readings = std::min(calibration.least_readings, level.readings.size());
    for (const GapReading& reading : level.readings) squares += std::pow(reading.volts.value - level.mean_v, 2);
  }
  const std::size_t freedom = readings.size() - levels.size();
  if (freedom > 0) calibration.repeat_v = std::sqrt(squares / static_cast<double>(freedom));
  return calibration;
}

}  // namespace dts::physics
