// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/two_feet_fit.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "physics/cop/cop_fit.h"
#include "physics/cop/cop_least_squares.h"
#include "physics/cop/sensed_plate.h"

namespace dts::physics {
namespace {

constexpr std::uint64_t kStanceSeed = 24;
/// The size of the sway counts more than its place: how much more, for the position and for the load.
constexpr double kPositionGainWeight = 10.0;
constexpr double kLoadGainWeight = 3.0;
constexpr double kRidge = 1e-7;          ///< Relative to the squares of a term.
constexpr double kSmallestPivot = 1e-8;  ///< The ridge determines every coefficient.
constexpr double kThesisTravelMm = 5.0;  ///< The thesis's sensors work over 5 mm.

using Arguments = std::array<double, TwoFeetPolynomial::kMaxFeatures>;
using Terms = std::array<double, TwoFeetPolynomial::kTermCount>;

/// One position of a stance: the features, and what the correction must add.
struct Observation {
  Arguments features{};  ///< x mm, y mm, load N, stated width mm.
  double x_mm = 0.0;
  double y_mm = 0.0;
  double log_load = 0.0;
};

/// The positions of one stance, the mean position first.
using Observations = std::vector<Observation>;

double load_of(const CopTrial& trial) {
  double sum_n = 0.0;
  for (const PlateLoad& load : trial.loads) sum_n += load.force.value;
  return sum_n;
}

core::Result<Observations> observe(const TwoFeetStance& stance, const SensedPlate& plate, const CopEstimator& points, TwoFeetFit& fit) {
  Observations seen;
  for (const CopTrial& trial : stance.positions) {
    const std::vector<double> deflection_mm = plate.deflection_mm(trial.loads);
    if (std::ranges::max(deflection_mm) > fit.form.travel_mm)
      fit.too_heavy_n = std::min(fit.too_heavy_n.value_or(load_of(trial)), load_of(trial));
    const CopEstimate estimate = points.estimate(deflection_mm);
    if ((estimate.flags & cop_flag::kNoContact) != 0) {
      return refuse_calibration("the plate model has no centre of pressure under a person on two feet",
                                "check plate, supports and sensors in the rig file");
    }
    seen.push_back({.features = {estimate.x_mm, estimate.y_mm, estimate.load_n, stance.stated_width_mm},
                    .x_mm = trial.centre.x.value - estimate.x_mm,
                    .y_mm = trial.centre.y.value - estimate.y_mm,
                    .log_load = std::log(load_of(trial) / estimate.load_n)});
  }
  return seen;
}

/// Computes mean, standard deviation and range of a feature; the range has the margin of a calibration.
TwoFeetPolynomial::Feature feature_of(std::span<const Observations> stances, std::size_t index) {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  Interval range{stances.front().front().features[index], stances.front().front().features[index]};
  for (const Observations& stance : stances) {
    for (const Observation& one : stance) {
      const double value = one.features[index];
      sum += value;
      squares += value * value;
      count += 1.0;
      range = {std::min(range.lowest, value), std::max(range.highest, value)};
    }
  }
  const double mean = sum / count;
  const double margin = kCopMargin * (range.highest - range.lowest);
  return {.mean = mean, .sd = std::sqrt(squares / count - mean * mean), .range = {range.lowest - margin, range.highest + margin}};
}

Terms terms_of(const TwoFeetPolynomial& polynomial, const Observation& seen) {
  Arguments arguments{};
  for (std::size_t f = 0; f < polynomial.feature_count; ++f) {
    arguments[f] = (seen.features[f] - polynomial.features[f].mean) / polynomial.features[f].sd;
  }
  return TwoFeetPolynomial::terms_of(arguments, polynomial.feature_count);
}

void add_row(LeastSquares& problem, const Terms& terms, std::span<const double> targets, double weight) {
  for (const double term : terms) problem.system.push_back(weight * term);
  for (const double target : targets) problem.targets.push_back(weight * target);
}

/// Returns the problem whose solution makes sum |r_k|^2 + gain_weight^2 sum |r_k - r_0|^2 over all stances smallest; r_k is what remains of
/// position k.
template <class Targets>
LeastSquares problem_of(const TwoFeetPolynomial& polynomial, std::span<const Observations> stances, double gain_weight,
                        Targets targets_of) {
  LeastSquares problem{.column_count = TwoFeetPolynomial::kTermCount,
                       .target_count = targets_of(Observation{}).size(),
                       .system = {},
                       .targets = {},
                       .ridge = {}};
  problem.rank_threshold = kSmallestPivot;
  for (const Observations& stance : stances) {
    const Terms mean_terms = terms_of(polynomial, stance.front());
    const auto mean_targets = targets_of(stance.front());
    add_row(problem, mean_terms, mean_targets, 1.0);
    for (const Observation& one : std::span(stance).subspan(1)) {
      Terms terms = terms_of(polynomial, one);
      auto targets = targets_of(one);
      add_row(problem, terms, targets, 1.0);
      for (std::size_t k = 0; k < terms.size(); ++k) terms[k] -= mean_terms[k];
      for (std::size_t k = 0; k < targets.size(); ++k) targets[k] -= mean_targets[k];
      add_row(problem, terms, targets, gain_weight);
    }
  }
  problem.ridge.assign(problem.column_count, 0.0);
  for (std::size_t k = 0; k < problem.system.size(); ++k) {
    problem.ridge[k % problem.column_count] += kRidge * problem.system[k] * problem.system[k];
  }
  return problem;
}

core::Result<TwoFeetPolynomial> fit(std::span<const Observations> stances, std::size_t feature_count) {
  TwoFeetPolynomial polynomial{.feature_count = feature_count};
  for (std::size_t f = 0; f < feature_count; ++f) polynomial.features[f] = feature_of(stances, f);
  DTS_TRY_ASSIGN(const auto position, solve(problem_of(polynomial, stances, kPositionGainWeight, [](const Observation& seen) {
                   return std::array{seen.x_mm, seen.y_mm};
                 })));
  DTS_TRY_ASSIGN(const auto load, solve(problem_of(polynomial, stances, kLoadGainWeight,
                                                   [](const Observation& seen) { return std::array{seen.log_load}; })));
  for (std::size_t k = 0; k < TwoFeetPolynomial::kTermCount; ++k) {
    polynomial.x_mm[k] = position.coefficients[2 * k];
    polynomial.y_mm[k] = position.coefficients[2 * k + 1];
    polynomial.log_load[k] = load.coefficients[k];
  }
  return polynomial;
}

double travel_of(const RigModel& rig) {
  double travel_mm = kThesisTravelMm;
  for (const SensorModel& sensor : rig.sensors) {
    travel_mm = std::min(travel_mm, sensor.unloaded_gap.value - sensor.curve.minimum_gap().value);
  }
  return travel_mm;
}

}  // namespace

core::Result<TwoFeetFit> fit_two_feet(CopMethod method, const RigModel& rig, std::size_t stances,
                                      const std::function<void(double)>& progress) {
  const std::vector<TwoFeetStance> library = two_feet_stances(rig.plate, stances, kStanceSeed);
  if (stances == 0 || library.size() < stances) {
    return refuse_calibration("a plate of " + std::to_string(rig.plate.a.value) + " x " + std::to_string(rig.plate.b.value) +
                              " mm is too small for a person on two feet");
  }
  DTS_TRY_ASSIGN(const auto points, CopEstimator::from_model(method, rig));
  DTS_TRY_ASSIGN(const auto plate, SensedPlate::create(rig, PlateBehaviour::Stiffening));
  TwoFeetFit fitted{.form = {.travel_mm = travel_of(rig)}};
  std::vector<Observations> seen;
  for (const TwoFeetStance& stance : library) {
    DTS_TRY_ASSIGN(auto observations, observe(stance, plate, points, fitted));
    seen.push_back(std::move(observations));
    progress(static_cast<double>(seen.size()) / static_cast<double>(library.size()));
  }
  DTS_TRY_ASSIGN(fitted.form.with_width, fit(seen, TwoFeetPolynomial::kMaxFeatures));
  DTS_TRY_ASSIGN(fitted.form.without_width, fit(seen, TwoFeetPolynomial::kMaxFeatures - 1));
  return fitted;
}

}  // namespace dts::physics
