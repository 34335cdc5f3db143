// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "physics/cop/cop_estimator.h"

namespace dts::physics {
namespace {

/// Features may leave the calibrated range by this part of it: noise at the border of the calibrated area is not extrapolation.
constexpr double kMargin = 0.01;
/// Loads this far apart show the plate's stiffening; closer ones are one load measured twice (plate-model 5.2).
constexpr double kLoadRatio = 2.0;
/// Positions closer than this are one position, and this is how far a point may lie beside a mid-line.
constexpr double kSamePositionMm = 1.0;
/// Smallest over largest pivot of the scaled system; grids have 0.005 and more.
constexpr double kRankThreshold = 1e-4;
/// A fit that misses its own samples by this part of the calibrated area has the wrong samples.
constexpr double kLargestMisfit = 0.05;

/// Calibrations have hundreds of samples; more are scans that should have been averaged.
constexpr std::size_t kMaxSamples = 10'000;

constexpr auto kSwapHint =
    "check the positions, and that the sensors are in the order w1 left back, w2 right back, w3 left front, w4 right front";

tl::unexpected<core::Error> refuse(std::string what, std::string hint = {}) {
  return core::fail(core::ErrorCode::InvalidArgument, "centre-of-pressure calibration: " + std::move(what), std::move(hint));
}

double sum_of(const CopSample& sample) {
  const auto& w = sample.deflection_mm;
  return w[0] + w[1] + w[2] + w[3];
}

core::Status check_samples(std::span<const CopSample> samples) {
  if (samples.empty()) return refuse("there are no samples");
  if (samples.size() > kMaxSamples) {
    return refuse(std::to_string(samples.size()) + " samples, at most " + std::to_string(kMaxSamples) + " are taken",
                  "average the scans of each position");
  }
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto& [position, load, w] = samples[k];
    const bool is_finite = std::isfinite(position.x.value) && std::isfinite(position.y.value) && std::isfinite(load.value) &&
                           std::all_of(w.begin(), w.end(), [](double value) { return std::isfinite(value); });
    if (!is_finite) return refuse("sample " + std::to_string(k) + " has a value that is not finite");
    if (!(load.value > 0.0)) {
      return refuse("the load of sample " + std::to_string(k) + " is " + std::to_string(load.value) + " N, must be positive");
    }
    const bool presses_each_pair = w[0] + w[2] > 0.0 && w[1] + w[3] > 0.0 && w[0] + w[1] > 0.0 && w[2] + w[3] > 0.0;
    if (!presses_each_pair) {
      return refuse("sample " + std::to_string(k) + " does not press every pair of sensors down",
                    "deflections count positive towards the sensors");
    }
  }
  return {};
}

std::size_t count_distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::size_t count = 0;
  double last = 0.0;
  for (const double value : values) {
    if (count > 0 && value - last < kSamePositionMm) continue;
    last = value;
    ++count;
  }
  return count;
}

/// How many columns and rows a grid through the positions would have, and how many positions there are.
struct Layout {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t positions = 0;

  [[nodiscard]] static Layout of(std::span<const CopSample> samples);
  [[nodiscard]] bool holds(std::size_t side) const { return columns >= side && rows >= side && positions >= side * side; }
};

Layout Layout::of(std::span<const CopSample> samples) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<Point> distinct;
  for (const auto& sample : samples) {
    const Point here = sample.load_position;
    x.push_back(here.x.value);
    y.push_back(here.y.value);
    const bool is_new = std::none_of(distinct.begin(), distinct.end(), [&](const Point& there) {
      return std::hypot((here.x - there.x).value, (here.y - there.y).value) < kSamePositionMm;
    });
    if (is_new) distinct.push_back(here);
  }
  return {count_distinct(x), count_distinct(y), distinct.size()};
}

struct Term {
  std::size_t u = 0;
  std::size_t v = 0;
  std::size_t sum = 0;
};

std::vector<Term> full_terms(std::size_t degree, std::size_t highest_sum) {
  std::vector<Term> terms;
  for (std::size_t s = 0; s <= highest_sum; ++s) {
    for (std::size_t i = 0; i <= degree; ++i) {
      for (std::size_t j = 0; i + j <= degree; ++j) terms.push_back({i, j, s});
    }
  }
  return terms;
}

/// Points on the two mid-lines say nothing about products of u and v.
std::vector<Term> mid_line_terms() {
  std::vector<Term> terms{{0, 0, 0}};
  for (std::size_t k = 1; k <= 4; ++k) {
    terms.push_back({k, 0, 0});
    terms.push_back({0, k, 0});
  }
  return terms;
}

/// Least squares by Householder QR with column pivoting on columns scaled to length 1.
core::Result<Eigen::MatrixXd> solve(Eigen::MatrixXd system, const Eigen::MatrixXd& targets) {
  const Eigen::RowVectorXd lengths = system.colwise().norm();
  if (lengths.minCoeff() > 0.0) system.array().rowwise() /= lengths.array();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kRankThreshold);
  qr.compute(system);
  if (system.rows() < system.cols() || qr.rank() < system.cols()) {
    return refuse(std::to_string(system.rows()) + " samples determine only " + std::to_string(qr.rank()) + " of " +
                      std::to_string(system.cols()) + " coefficients",
                  "spread the positions over the area between the sensors");
  }
  Eigen::MatrixXd solution = qr.solve(targets);
  solution.array().colwise() /= lengths.transpose().array();
  return solution;
}

}  // namespace

/// Fills in a CopEstimator step by step.
class CopFit {
 public:
  CopFit(CopMethod method, std::span<const CopSample> samples) : samples_(samples) {
    estimator_.method_ = method;
    find_ranges();
  }

  core::Result<CopEstimator> run() {
    const auto fitted = estimator_.method_ == CopMethod::Thesis ? fit_thesis() : fit_poly3();
    if (!fitted) return tl::make_unexpected(fitted.error());
    if (const auto status = check_misfit(); !status) return tl::make_unexpected(status.error());
    return estimator_;
  }

 private:
  using Interval = CopEstimator::Interval;

  template <class Feature>
  [[nodiscard]] static Interval extremes_of(std::span<const CopSample> samples, Feature feature) {
    Interval range{feature(samples.front()), feature(samples.front())};
    for (const auto& sample : samples) {
      range.lowest = std::min(range.lowest, feature(sample));
      range.highest = std::max(range.highest, feature(sample));
    }
    return range;
  }

  template <class Feature>
  [[nodiscard]] static Interval range_of(std::span<const CopSample> samples, Feature feature) {
    const auto [lowest, highest] = extremes_of(samples, feature);
    const double margin = kMargin * (highest - lowest);
    return {lowest - margin, highest + margin};
  }

  static double x_of(const CopSample& sample) { return sample.load_position.x.value; }
  static double y_of(const CopSample& sample) { return sample.load_position.y.value; }
  static double u_of(const CopSample& sample) {
    const auto& w = sample.deflection_mm;
    return (w[1] + w[3] - w[0] - w[2]) / sum_of(sample);
  }
  static double v_of(const CopSample& sample) {
    const auto& w = sample.deflection_mm;
    return (w[2] + w[3] - w[0] - w[1]) / sum_of(sample);
  }
  static double x_ratio_of(const CopSample& sample) {
    const auto& w = sample.deflection_mm;
    return (w[0] + w[2]) / (w[1] + w[3]);
  }
  static double y_ratio_of(const CopSample& sample) {
    const auto& w = sample.deflection_mm;
    return (w[0] + w[1]) / (w[2] + w[3]);
  }

  void find_ranges() {
    auto& e = estimator_;
    e.x_mm_ = range_of(samples_, x_of);
    e.y_mm_ = range_of(samples_, y_of);
    e.u_ = range_of(samples_, u_of);
    e.v_ = range_of(samples_, v_of);
    e.reference_sum_mm_ = 0.0;
    for (const auto& sample : samples_) e.reference_sum_mm_ += sum_of(sample) / static_cast<double>(samples_.size());
    e.relative_sum_ = range_of(samples_, [&](const CopSample& sample) { return sum_of(sample) / e.reference_sum_mm_; });
  }

  /// Fits the outputs from `first_output` on (x, y, sum per load) with `terms`.
  core::Status fit_polynomials(const std::vector<Term>& terms, std::size_t first_output) {
    Eigen::MatrixXd system(samples_.size(), terms.size());
    Eigen::MatrixXd targets(samples_.size(), 3);
    for (Eigen::Index row = 0; row < system.rows(); ++row) {
      const CopSample& sample = samples_[static_cast<std::size_t>(row)];
      const double sum = sum_of(sample);
      for (Eigen::Index column = 0; column < system.cols(); ++column) {
        const Term& term = terms[static_cast<std::size_t>(column)];
        system(row, column) =
            std::pow(u_of(sample), term.u) * std::pow(v_of(sample), term.v) * std::pow(sum / estimator_.reference_sum_mm_, term.sum);
      }
      targets.row(row) << x_of(sample), y_of(sample), sum / sample.load.value;
    }
    const auto solution = solve(std::move(system), targets);
    if (!solution) return tl::make_unexpected(solution.error());
    for (std::size_t k = 0; k < terms.size(); ++k) {
      Quintic& polynomial = terms[k].sum == 0 ? estimator_.polynomial_ : estimator_.sum_polynomial_;
      for (std::size_t output = first_output; output < 3; ++output) {
        polynomial.coefficients[Quintic::index(terms[k].u, terms[k].v)][output] =
            (*solution)(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(output));
      }
    }
    return {};
  }

  core::Status fit_poly3() {
    const auto [light, heavy] = split_by_load();
    estimator_.uses_sum_ = !heavy.empty();
    const Layout layout = Layout::of(light);
    const Layout heavy_layout = heavy.empty() ? layout : Layout::of(heavy);
    for (const std::size_t degree : {Quintic::kDegree, std::size_t{3}}) {
      if (!layout.holds(degree + 1) || !heavy_layout.holds(degree + 1)) continue;
      return fit_polynomials(full_terms(degree, estimator_.uses_sum_ ? 1 : 0), 0);
    }
    const auto& worse = layout.holds(4) ? heavy_layout : layout;
    return refuse(std::to_string(worse.positions) + " positions in " + std::to_string(worse.columns) + " columns and " +
                      std::to_string(worse.rows) + " rows are too few for poly3" + (heavy.empty() ? "" : " at each of the loads"),
                  "measure at least 4 x 4 positions, better 7 x 7");
  }

  /// Light and heavy samples; the second is empty when the loads are less than `kLoadRatio` apart.
  [[nodiscard]] std::pair<std::vector<CopSample>, std::vector<CopSample>> split_by_load() const {
    const auto by_load = [](const CopSample& a, const CopSample& b) { return a.load < b.load; };
    const auto [lightest, heaviest] = std::minmax_element(samples_.begin(), samples_.end(), by_load);
    std::vector<CopSample> light(samples_.begin(), samples_.end());
    if (heaviest->load / lightest->load < kLoadRatio) return {light, {}};
    const double middle_n = std::sqrt(lightest->load.value * heaviest->load.value);
    const auto border = std::partition(light.begin(), light.end(), [&](const CopSample& sample) { return sample.load.value < middle_n; });
    std::vector<CopSample> heavy(border, light.end());
    light.erase(border, light.end());
    return {light, heavy};
  }

  core::Status fit_thesis() {
    const double middle_x = 0.5 * (estimator_.x_mm_.lowest + estimator_.x_mm_.highest);
    const double middle_y = 0.5 * (estimator_.y_mm_.lowest + estimator_.y_mm_.highest);
    std::vector<CopSample> along_x;
    std::vector<CopSample> along_y;
    for (const auto& sample : samples_) {
      if (std::abs(y_of(sample) - middle_y) < kSamePositionMm) along_x.push_back(sample);
      if (std::abs(x_of(sample) - middle_x) < kSamePositionMm) along_y.push_back(sample);
    }
    auto& e = estimator_;
    if (auto status = fit_quartic("x", along_x, x_of, x_ratio_of, e.x_quartic_, e.x_ratio_); !status) return status;
    if (auto status = fit_quartic("y", along_y, y_of, y_ratio_of, e.y_quartic_, e.y_ratio_); !status) return status;
    const Layout layout = Layout::of(samples_);
    return fit_polynomials(layout.holds(6) ? full_terms(5, 0) : layout.holds(4) ? full_terms(3, 0) : mid_line_terms(), 2);
  }

  /// Thesis eq. 4.1. In r - 1, which is 0 in the middle of the line, the five columns stay well apart.
  template <class Coordinate, class Ratio>
  static core::Status fit_quartic(const std::string& axis, std::vector<CopSample>& line, Coordinate coordinate, Ratio ratio,
                                  CopEstimator::Quartic& quartic, Interval& range) {
    std::sort(line.begin(), line.end(), [&](const CopSample& a, const CopSample& b) { return coordinate(a) < coordinate(b); });
    std::vector<double> coordinates;
    coordinates.reserve(line.size());
    for (const auto& sample : line) coordinates.push_back(coordinate(sample));
    if (const auto count = count_distinct(coordinates); count < quartic.size()) {
      return refuse("the mid-line along " + axis + " has " + std::to_string(count) + " positions, the thesis method needs 5");
    }
    for (std::size_t k = 1; k < line.size(); ++k) {
      if (coordinates[k] - coordinates[k - 1] < kSamePositionMm || ratio(line[k]) < ratio(line[k - 1])) continue;
      return refuse("the ratio of the sensor pairs does not fall along " + axis + " from " + std::to_string(coordinates[k - 1]) + " to " +
                        std::to_string(coordinates[k]) + " mm",
                    kSwapHint);
    }
    const auto [lowest, highest] = extremes_of(line, ratio);
    const double margin = std::pow(highest / lowest, kMargin);  // as a factor: the mirrored load has the inverse ratio
    range = {lowest / margin, highest * margin};
    Eigen::MatrixXd system(line.size(), quartic.size());
    for (Eigen::Index row = 0; row < system.rows(); ++row) {
      for (Eigen::Index power = 0; power < system.cols(); ++power) {
        system(row, power) = std::pow(ratio(line[static_cast<std::size_t>(row)]) - 1.0, power);
      }
    }
    const auto solution =
        solve(std::move(system), Eigen::Map<const Eigen::VectorXd>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size())));
    if (!solution) return tl::make_unexpected(solution.error());
    std::copy(solution->data(), solution->data() + quartic.size(), quartic.begin());
    return {};
  }

  [[nodiscard]] core::Status check_misfit() const {
    double squares = 0.0;
    for (const auto& sample : samples_) {
      const auto estimate = estimator_.estimate(sample.deflection_mm);
      squares += std::pow(estimate.x_mm - x_of(sample), 2) + std::pow(estimate.y_mm - y_of(sample), 2);
    }
    const double misfit_mm = std::sqrt(squares / static_cast<double>(samples_.size()));
    const double span_mm = std::min(estimator_.x_mm_.highest - estimator_.x_mm_.lowest, estimator_.y_mm_.highest - estimator_.y_mm_.lowest);
    if (misfit_mm <= kLargestMisfit * span_mm) return {};
    return refuse("the result misses its own samples by " + std::to_string(misfit_mm) + " mm rms", kSwapHint);
  }

  std::span<const CopSample> samples_;
  CopEstimator estimator_;
};

core::Result<CopEstimator> CopEstimator::fit(CopMethod method, std::span<const CopSample> samples) {
  if (const auto status = check_samples(samples); !status) return tl::make_unexpected(status.error());
  return CopFit(method, samples).run();
}

}  // namespace dts::physics
