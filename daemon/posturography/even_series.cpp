// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "posturography/cop_series.h"

namespace dts::posturography {
namespace {

using core::ErrorCode;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr double kEven = 0.01;            ///< Of a step: largest distance of even stamps from the grid.
constexpr double kWritten = 0.51;         ///< Of the last written decimal: rounding changes at most half.
constexpr double kLinear = 0.1;           ///< Of a step: above this, interpolation damages velocities.
constexpr double kLongestCellS = 0.025;   ///< Range of a sample to either side; twice this is the longest gap that is bridged.
constexpr double kSparseFactor = 16.0;    ///< Samples per row: limits memory in proportion to the input.
constexpr double kSparseAllowance = 1e6;  ///< Additional samples that any file may have.
constexpr double kManyMissing = 0.1;      ///< More missing samples than this fraction are unlikely to be chance.
constexpr int kMostDecimals = 9;
constexpr double kWrittenTolerance = 1e-6;  ///< Of one unit in the last decimal.

/// Rows on a grid: row i is sample index[i], at origin + index / rate.
struct Grid {
  double rate_hz = 0.0;
  double origin_s = 0.0;
  double off_s = 0.0;  ///< Largest distance of a row from the grid.
  std::vector<double> index;

  [[nodiscard]] double samples() const noexcept { return index.back() + 1.0; }
};

/// Returns one unit of the last decimal of the written stamps; 0 if they were not rounded.
double written_unit_s(std::span<const double> t_s) {
  double scale = 1.0;
  for (int decimals = 0; decimals <= kMostDecimals; ++decimals, scale *= 10.0) {
    const bool is_written = std::all_of(t_s.begin(), t_s.end(), [scale](double t) {
      const double units = t * scale;
      // A Unix time (1.7e9 s) has fewer decimals than 1e-6 of a unit; with a tolerance above a tenth, no decision is possible.
      const double tolerance = std::max(kWrittenTolerance, 2.0 * std::numeric_limits<double>::epsilon() * std::abs(units));
      return tolerance < 0.1 && std::abs(units - std::round(units)) <= tolerance;
    });
    if (is_written) return 1.0 / scale;
  }
  return 0.0;
}

/// Returns the time between rows where none is missing: the median of the differences, then the mean of the differences near it, because
/// the median of rounded stamps can be off by half a unit.
double step_s(std::span<const double> t_s) {
  std::vector<double> steps(t_s.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = t_s[i + 1] - t_s[i];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double median = *middle;
  double sum = 0.0;
  double count = 0.0;
  for (const double step : steps) {
    if (step >= 1.5 * median) continue;
    sum += step;
    count += 1.0;
  }
  return sum / count;
}

std::vector<double> indices(std::span<const double> t_s, double step) {
  std::vector<double> index(t_s.size(), 0.0);
  for (std::size_t i = 1; i < t_s.size(); ++i) index[i] = index[i - 1] + std::max(1.0, std::round((t_s[i] - t_s[i - 1]) / step));
  return index;
}

/// Returns whole Hz if that rate agrees with the written digits of the first and the last stamp.
double simplest_rate_hz(double steps, double span_s, double unit_s) {
  const double rate_hz = steps / span_s;
  const double whole_hz = std::round(rate_hz);
  if (whole_hz < 1.0) return rate_hz;
  const double allowed_s = std::max(2.0 * kWritten * unit_s, 1e-9 * span_s);
  return std::abs(steps / whole_hz - span_s) <= allowed_s ? whole_hz : rate_hz;
}

/// Returns the slope of time over index by least squares: the two ends alone would include the rounding of two stamps.
double fitted_step_s(std::span<const double> t_s, const std::vector<double>& index) {
  const auto count = static_cast<double>(t_s.size());
  double mean_index = 0.0;
  double mean_t = 0.0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    mean_index += index[i] / count;
    mean_t += (t_s[i] - t_s[0]) / count;
  }
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    products += (index[i] - mean_index) * (t_s[i] - t_s[0] - mean_t);
    squares += (index[i] - mean_index) * (index[i] - mean_index);
  }
  return products / squares;
}

Grid grid_of(std::span<const double> t_s, std::vector<double> index, double unit_s) {
  Grid grid;
  const double span_s = t_s.back() - t_s.front();
  grid.rate_hz = simplest_rate_hz(index.back(), span_s, unit_s);
  const bool is_whole = grid.rate_hz == std::round(grid.rate_hz);
  if (!is_whole) grid.rate_hz = 1.0 / fitted_step_s(t_s, index);
  double least = 0.0;
  double most = 0.0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    const double off = t_s[i] - t_s[0] - index[i] / grid.rate_hz;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  grid.origin_s = t_s[0] + 0.5 * (least + most);
  grid.off_s = 0.5 * (most - least);
  grid.index = std::move(index);
  return grid;
}

bool is_even(const Grid& grid, double unit_s) { return grid.off_s <= std::max(kEven / grid.rate_hz, kWritten * unit_s); }

/// Returns the grid of the rows with gaps, or the grid without a gap if the first would miss a tenth of the samples and the second also
/// fits: 75 Hz in two decimals is 0.00, 0.01, 0.03, 0.04, and not 100 Hz with every fourth sample lost.
Grid likeliest_grid(std::span<const double> t_s, double unit_s) {
  Grid grid = grid_of(t_s, indices(t_s, step_s(t_s)), unit_s);
  const auto rows = static_cast<double>(t_s.size());
  if (grid.samples() * (1.0 - kManyMissing) <= rows) return grid;
  std::vector<double> index(t_s.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = static_cast<double>(i);
  Grid without_gap = grid_of(t_s, std::move(index), unit_s);
  return is_even(without_gap, unit_s) ? without_gap : grid;
}

struct Column {
  std::span<const double> rows;
  std::vector<double>& samples;
};

void place(const Grid& grid, const Column& column) {
  for (std::size_t i = 0; i < column.rows.size(); ++i) column.samples[static_cast<std::size_t>(grid.index[i])] = column.rows[i];
}

/// Interpolates linearly between neighbouring rows that are at most one and a half steps apart; NaN in gaps.
void interpolate(std::span<const double> t_s, const Grid& grid, const Column& column) {
  std::size_t after = 1;
  for (std::size_t k = 0; k < column.samples.size(); ++k) {
    const double at = std::clamp(grid.origin_s + static_cast<double>(k) / grid.rate_hz, t_s.front(), t_s.back());
    while (after + 1 < t_s.size() && t_s[after] < at) ++after;
    const double apart = t_s[after] - t_s[after - 1];
    if (apart * grid.rate_hz > 1.5) {
      // A gap: its ends still count for the nearest sample.
      const std::size_t nearest = at - t_s[after - 1] < t_s[after] - at ? after - 1 : after;
      if (std::abs(t_s[nearest] - at) * grid.rate_hz < 2.0 * kLinear) column.samples[k] = column.rows[nearest];
      continue;
    }
    const double part = (at - t_s[after - 1]) / apart;
    column.samples[k] = column.rows[after - 1] + part * (column.rows[after] - column.rows[after - 1]);
  }
}

/// Returns the mean over a window of two steps of a signal that keeps each row's value half way to its neighbours; NaN where rows cover
/// less than half of the window. Two steps: 80 ms at 25 Hz, as in Quijoux et al. 2021.
void average(std::span<const double> t_s, const Grid& grid, const Column& column) {
  const double half_window_s = 1.0 / grid.rate_hz;
  const double reach_s = std::max(half_window_s, kLongestCellS);
  std::size_t first = 0;
  const auto cell_end = [&](std::size_t i) {
    return i + 1 < t_s.size() ? std::min(0.5 * (t_s[i] + t_s[i + 1]), t_s[i] + reach_s) : t_s[i] + reach_s;
  };
  const auto cell_begin = [&](std::size_t i) { return i > 0 ? std::max(0.5 * (t_s[i - 1] + t_s[i]), t_s[i] - reach_s) : t_s[i] - reach_s; };
  for (std::size_t k = 0; k < column.samples.size(); ++k) {
    const double at = t_s.front() + static_cast<double>(k) / grid.rate_hz;
    while (first + 1 < t_s.size() && cell_end(first) <= at - half_window_s) ++first;
    double weight = 0.0;
    double sum = 0.0;
    for (std::size_t i = first; i < t_s.size() && cell_begin(i) < at + half_window_s; ++i) {
      const double covered = std::min(cell_end(i), at + half_window_s) - std::max(cell_begin(i), at - half_window_s);
      if (!(covered > 0.0) || !std::isfinite(column.rows[i])) continue;
      weight += covered;
      sum += covered * column.rows[i];
    }
    if (weight >= half_window_s) column.samples[k] = sum / weight;
  }
}

void fill(std::span<const double> t_s, const Grid& grid, const Column& column, std::uint32_t flags) {
  if ((flags & sway_flag::kWindowAveraged) != 0) {
    average(t_s, grid, column);
  } else if ((flags & sway_flag::kResampled) != 0) {
    interpolate(t_s, grid, column);
  } else {
    place(grid, column);
  }
}

core::Status check(std::span<const double> t_s, std::span<const double> ml_mm, std::span<const double> ap_mm,
                   std::span<const double> load_n) {
  const auto invalid = [](std::string what) { return core::fail(ErrorCode::InvalidArgument, std::move(what)); };
  if (ml_mm.size() != t_s.size() || ap_mm.size() != t_s.size() || (!load_n.empty() && load_n.size() != t_s.size())) {
    return invalid("the columns of the centre of pressure are not equally long");
  }
  if (t_s.size() < 2) return invalid("a centre of pressure of " + std::to_string(t_s.size()) + " rows: at least two are needed");
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (!std::isfinite(t_s[i])) return invalid("the time of row " + std::to_string(i + 1) + " is not a number");
    if (i > 0 && t_s[i] <= t_s[i - 1]) {
      return invalid("the time of row " + std::to_string(i + 1) + " is not later than that of the row before");
    }
  }
  const double span_s = t_s.back() - t_s.front();
  if (!std::isfinite(span_s) || span_s < std::numeric_limits<double>::min()) return invalid("the times are not valid times in seconds");
  return {};
}

}  // namespace

core::Result<CopSeries> even_series(std::span<const double> t_s, std::span<const double> ml_mm, std::span<const double> ap_mm,
                                    std::span<const double> load_n) {
  DTS_TRY(check(t_s, ml_mm, ap_mm, load_n));
  const double unit_s = written_unit_s(t_s);
  Grid grid = likeliest_grid(t_s, unit_s);
  CopSeries series;
  if (!is_even(grid, unit_s)) {
    const bool is_linear = grid.off_s * grid.rate_hz < kLinear;
    series.flags |= is_linear ? sway_flag::kResampled : sway_flag::kWindowAveraged;
    // The index of such a row may be far off, so the rate is computed from the usual step.
    if (!is_linear) grid.rate_hz = std::max(1.0, std::round(1.0 / step_s(t_s)));
  }
  const double samples =
      (series.flags & sway_flag::kWindowAveraged) != 0 ? std::floor((t_s.back() - t_s.front()) * grid.rate_hz) + 1.0 : grid.samples();
  if (!std::isfinite(grid.rate_hz) || !(samples <= kSparseFactor * static_cast<double>(t_s.size()) + kSparseAllowance)) {
    return core::fail(ErrorCode::InvalidArgument,
                      std::to_string(t_s.size()) + " rows over " + std::to_string(t_s.back() - t_s.front()) + " s: the gaps are too long",
                      "cut the file at its longest gap");
  }
  series.rate_hz = grid.rate_hz;
  const auto count = static_cast<std::size_t>(samples);
  series.ml_mm.assign(count, kMissing);
  series.ap_mm.assign(count, kMissing);
  fill(t_s, grid, {ml_mm, series.ml_mm}, series.flags);
  fill(t_s, grid, {ap_mm, series.ap_mm}, series.flags);
  if (!load_n.empty()) {
    series.load_n.assign(count, kMissing);
    fill(t_s, grid, {load_n, series.load_n}, series.flags);
  }
  return series;
}

}  // namespace dts::posturography
