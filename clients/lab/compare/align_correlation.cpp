// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "cli/table.h"
#include "lab/compare/alignment.h"
#include "lab/compare/clock_fit.h"

namespace dts::lab::compare {
namespace {

constexpr double kSearchRateHz = 50.0;           ///< For the search for the lag; sway has nothing above 10 Hz.
constexpr double kMostSearchSamples = 20'000.0;  ///< The search time grows with the square.
constexpr double kLeastOverlap = 0.5;            ///< Of the shorter recording.
constexpr double kFirstWindowS = 60.0;
constexpr double kSmoothingS = 0.1;
constexpr double kMostPoints = 200'000.0;
constexpr int kMostSteps = 30;
constexpr double kWindowS = 20.0;  ///< Shortest window of a long recording.
constexpr double kMostWindows = 60.0;
constexpr double kFewestWindows = 6.0;
constexpr double kMostOffS = 0.5;  ///< A window further off the line of all found another movement.
constexpr auto kUnlikeHint =
    "check that the recordings overlap by at least half and have the same axes; or add two or more events in a column trigger or marker";

/// Both axes on even steps, and running sums for the moments of any stretch. Gaps count as the mean.
struct Sampled {
  std::array<std::vector<double>, 2> axes;  ///< Mean removed.
  std::array<std::vector<double>, 2> sums;
  std::array<std::vector<double>, 2> squares;

  [[nodiscard]] std::size_t size() const { return axes[0].size(); }
};

Sampled sampled(const Recording& recording, double step_s) {
  Sampled result;
  const std::array<const std::vector<double>*, 2> columns{&recording.x_mm, &recording.y_mm};
  const auto count = static_cast<std::size_t>((recording.t_s.back() - recording.t_s.front()) / step_s) + 1;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const SmoothSeries series(recording.t_s, *columns[axis]);
    std::vector<double>& values = result.axes[axis];
    double sum = 0.0;
    std::size_t defined = 0;
    for (std::size_t k = 0; k < count; ++k) {
      values.push_back(series.at(recording.t_s.front() + static_cast<double>(k) * step_s).value);
      if (std::isfinite(values.back())) {
        sum += values.back();
        ++defined;
      }
    }
    const double mean = defined == 0 ? 0.0 : sum / static_cast<double>(defined);
    result.sums[axis].push_back(0.0);
    result.squares[axis].push_back(0.0);
    for (double& value : values) {
      value = std::isfinite(value) ? value - mean : 0.0;
      result.sums[axis].push_back(result.sums[axis].back() + value);
      result.squares[axis].push_back(result.squares[axis].back() + value * value);
    }
  }
  return result;
}

/// Returns the correlation over a stretch, with the covariances of both axes summed.
double correlation_at(const Sampled& a, std::size_t first_a, const Sampled& b, std::size_t first_b, std::size_t count) {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  const auto n = static_cast<double>(count);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto stretch = [count](const std::vector<double>& sums, std::size_t first) { return sums[first + count] - sums[first]; };
    const double sum_a = stretch(a.sums[axis], first_a);
    const double sum_b = stretch(b.sums[axis], first_b);
    double products = 0.0;
    for (std::size_t k = 0; k < count; ++k) products += a.axes[axis][first_a + k] * b.axes[axis][first_b + k];
    ab += products - sum_a * sum_b / n;
    aa += stretch(a.squares[axis], first_a) - sum_a * sum_a / n;
    bb += stretch(b.squares[axis], first_b) - sum_b * sum_b / n;
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

struct Lag {
  double offset_s = 0.0;
  double correlation = 0.0;
};

/// Tries every lag with enough overlap.
Lag best_lag(const Recording& a, const Recording& b) {
  const double longest_s = std::max(a.t_s.back() - a.t_s.front(), b.t_s.back() - b.t_s.front());
  const double step_s = std::max({1.0 / kSearchRateHz, longest_s / kMostSearchSamples, a.step_s(), b.step_s()});
  const Sampled of_a = sampled(a, step_s);
  const Sampled of_b = sampled(b, step_s);
  const auto size_a = static_cast<std::int64_t>(of_a.size());
  const auto size_b = static_cast<std::int64_t>(of_b.size());
  const auto least = static_cast<std::int64_t>(kLeastOverlap * static_cast<double>(std::min(size_a, size_b)));
  Lag best;
  for (std::int64_t lag = least - size_b; lag <= size_a - least; ++lag) {  // b[k] is compared with a[k + lag]
    const std::int64_t first_b = std::max<std::int64_t>(0, -lag);
    const std::int64_t count = std::min(size_b, size_a - lag) - first_b;
    if (count < least || count < 2) continue;
    const double correlation = correlation_at(of_a, static_cast<std::size_t>(first_b + lag), of_b, static_cast<std::size_t>(first_b),
                                              static_cast<std::size_t>(count));
    if (correlation > best.correlation) best = {a.t_s.front() - b.t_s.front() + static_cast<double>(lag) * step_s, correlation};
  }
  return best;
}

/// Returns the mean within kSmoothingS, applied twice: the slope of a noisy recording would be noise, and noise in the slopes biases the
/// offset towards its start value. Symmetrical, so that nothing moves in time.
std::vector<double> smoothed(const Recording& recording, std::vector<double> values) {
  const double step_s = recording.step_s();
  const auto half = static_cast<std::size_t>(kSmoothingS / 2.0 / step_s);
  const double longest_s = 1.5 * step_s * static_cast<double>(2 * half);
  for (int pass = 0; pass < 2 && half > 0; ++pass) {
    std::vector<double> means(values.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = half; k + half < values.size(); ++k) {
      if (recording.t_s[k + half] - recording.t_s[k - half] > longest_s) continue;
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(k - half);
      const auto count = static_cast<std::ptrdiff_t>(2 * half + 1);
      means[k] = std::accumulate(first, first + count, 0.0) / static_cast<double>(count);
    }
    values = std::move(means);
  }
  return values;
}

/// a(t + offset + drift (t - reference)) = mean + gain b(t), both axes: Gauss-Newton.
class Refinement {
 public:
  Refinement(const Recording& a, const Recording& b, double offset_s)
      : b_t_s_(b.t_s),
        b_x_mm_(smoothed(b, b.x_mm)),
        b_y_mm_(smoothed(b, b.y_mm)),
        a_x_(a.t_s, smoothed(a, a.x_mm)),
        a_y_(a.t_s, smoothed(a, a.y_mm)) {
    const double from_s = std::max(b.t_s.front(), a.t_s.front() - offset_s);
    const double to_s = std::min(b.t_s.back(), a.t_s.back() - offset_s);
    reference_s_ = (from_s + to_s) / 2.0;
    half_s_ = (to_s - from_s) / 2.0;
    unknowns_ << offset_s, 0.0, 0.0, 0.0, 1.0, 1.0;
  }

  /// The stretch of B's times that A covers.
  [[nodiscard]] double from_s() const { return reference_s_ - half_s_; }
  [[nodiscard]] double to_s() const { return reference_s_ + half_s_; }

  /// Widens the window step by step: over a short window the drift of a clock causes little error.
  core::Result<Alignment> run() {
    for (double window_s = kFirstWindowS / 2.0; window_s < half_s_; window_s *= 2.0) (void)solve(window_s);
    if (!solve(half_s_)) return core::fail(core::ErrorCode::Failed, "the alignment of the recordings does not converge", kUnlikeHint);
    return Alignment{.offset_s = unknowns_[0],
                     .offset_sd_s = std::sqrt(covariance_(0, 0)),
                     .drift_ppm = unknowns_[1],
                     .drift_sd_ppm = std::sqrt(covariance_(1, 1)),
                     .reference_s = reference_s_};
  }

  /// Reads both clocks in the window of B's times, starting from the result of `run`. Nothing if the signals do not show the offset there.
  [[nodiscard]] std::optional<ClockReading> read_window(const Alignment& line, double from_s, double to_s) {
    reference_s_ = (from_s + to_s) / 2.0;
    is_drift_fixed_ = true;
    const double expected_s = line.to_a_s(reference_s_) - reference_s_;
    unknowns_ << expected_s, line.drift_ppm, 0.0, 0.0, 1.0, 1.0;
    if (!solve((to_s - from_s) / 2.0)) return std::nullopt;
    const ClockReading reading{.b_s = reference_s_, .late_s = unknowns_[0], .sd_s = std::max(std::sqrt(covariance_(0, 0)), kLeastSdS)};
    const bool is_near = std::abs(reading.late_s - expected_s) < kMostOffS && std::isfinite(reading.sd_s);
    return is_near ? std::optional(reading) : std::nullopt;
  }

 private:
  static constexpr double kLeastSdS = 1e-9;

  using Vector = Eigen::Matrix<double, 6, 1>;  ///< offset s, drift ppm, means x y mm, gains x y.
  using Matrix = Eigen::Matrix<double, 6, 6>;

  struct Sums {
    Matrix normal = Matrix::Zero();
    Vector right = Vector::Zero();
    double squares = 0.0;
    double neighbours = 0.0;  ///< Sum of products of neighbouring residuals.
    double count = 0.0;
  };

  bool solve(double window_s) {
    for (int step = 0; step < kMostSteps; ++step) {
      Sums sums = accumulate(window_s);
      if (is_drift_fixed_) {
        sums.normal.row(1).setZero();
        sums.normal.col(1).setZero();
        sums.normal(1, 1) = 1.0;
        sums.right[1] = 0.0;
      }
      const Eigen::LDLT<Matrix> factors(sums.normal);
      if (sums.count < 12.0 || factors.info() != Eigen::Success || !factors.isPositive()) return false;
      const Vector change = factors.solve(sums.right);
      if (!change.allFinite()) return false;
      unknowns_ += change;
      // Residuals of sway are similar from scan to scan, so there are fewer independent ones than scans (first-order autoregression).
      const double alike = sums.squares > 0.0 ? std::clamp(sums.neighbours / sums.squares, 0.0, 0.999) : 0.0;
      const double variance = sums.squares / (sums.count - 6.0) * (1.0 + alike) / (1.0 - alike);
      covariance_ = variance * factors.solve(Matrix::Identity());
      if (std::abs(change[0]) < 1e-8 && std::abs(change[1]) < 1e-4) return true;
    }
    return false;
  }

  [[nodiscard]] Sums accumulate(double window_s) const {
    Sums sums;
    const auto stride = 1 + static_cast<std::size_t>(static_cast<double>(b_t_s_.size()) / kMostPoints);
    double last_x = 0.0;
    double last_y = 0.0;
    const auto first = std::ranges::lower_bound(b_t_s_, reference_s_ - window_s) - b_t_s_.begin();
    for (auto row = static_cast<std::size_t>(first); row < b_t_s_.size(); row += stride) {
      const double from_middle_s = b_t_s_[row] - reference_s_;
      if (from_middle_s > window_s) break;
      const double at_s = b_t_s_[row] + unknowns_[0] + 1e-6 * unknowns_[1] * from_middle_s;
      add(sums, a_x_.at(at_s), b_x_mm_[row], 0, from_middle_s, last_x);
      add(sums, a_y_.at(at_s), b_y_mm_[row], 1, from_middle_s, last_y);
    }
    return sums;
  }

  void add(Sums& sums, const SmoothSeries::Value& a, double b_mm, int axis, double from_middle_s, double& last) const {
    if (!std::isfinite(a.value) || !std::isfinite(b_mm)) return;
    const double residual = unknowns_[2 + axis] + unknowns_[4 + axis] * b_mm - a.value;
    Vector row = Vector::Zero();
    row[0] = a.slope_per_s;
    row[1] = 1e-6 * a.slope_per_s * from_middle_s;
    row[2 + axis] = -1.0;
    row[4 + axis] = -b_mm;
    sums.normal += row * row.transpose();
    sums.right += row * residual;
    sums.squares += residual * residual;
    sums.neighbours += residual * last;
    sums.count += 1.0;
    last = residual;
  }

  const std::vector<double>& b_t_s_;
  std::vector<double> b_x_mm_;
  std::vector<double> b_y_mm_;
  SmoothSeries a_x_;
  SmoothSeries a_y_;
  double reference_s_ = 0.0;
  double half_s_ = 0.0;
  bool is_drift_fixed_ = false;
  Vector unknowns_ = Vector::Zero();
  Matrix covariance_ = Matrix::Zero();
};

/// A long recording is aligned window by window, so that a gap, a restarted clock or another movement in one of them does not matter.
/// Returns nothing if there are too few windows.
std::optional<Alignment> align_windows(const Recording& a, const Recording& b, Refinement& refinement, const Alignment& line) {
  const double from_s = refinement.from_s();
  const double length_s = refinement.to_s() - from_s;
  const double count = std::floor(std::min(kMostWindows, length_s / kWindowS));
  if (count < kFewestWindows) return std::nullopt;
  const Restarts restarts(a, b);
  std::vector<ClockReading> readings;
  for (double k = 0.0; k < count; k += 1.0) {
    const double begin_s = from_s + length_s * k / count;
    const double end_s = from_s + length_s * (k + 1.0) / count;
    if (restarts.piece_at(line.to_a_s(begin_s), begin_s) != restarts.piece_at(line.to_a_s(end_s), end_s)) continue;
    if (const auto reading = refinement.read_window(line, begin_s, end_s)) readings.push_back(*reading);
  }
  if (static_cast<double>(readings.size()) < kFewestWindows) return std::nullopt;
  auto fitted = fit_clocks(readings, restarts);
  if (!fitted || !std::isfinite(fitted->drift_ppm)) return std::nullopt;
  fitted->window_count = std::exchange(fitted->event_count, 0);
  return *fitted;
}

}  // namespace

core::Result<Alignment> align_by_correlation(const Recording& a, const Recording& b) {
  const Lag lag = best_lag(a, b);
  if (lag.correlation < kLeastCorrelation) {
    return core::fail(core::ErrorCode::Failed,
                      "the recordings do not show the same movement: their correlation is at most " + cli::decimal(lag.correlation, 2),
                      kUnlikeHint);
  }
  Refinement refinement(a, b, lag.offset_s);
  DTS_TRY_ASSIGN(auto alignment, refinement.run());
  if (const auto by_windows = align_windows(a, b, refinement, alignment)) alignment = *by_windows;
  alignment.means = Alignment::Means::Correlation;
  alignment.peak_correlation = lag.correlation;
  return alignment;
}

}  // namespace dts::lab::compare
