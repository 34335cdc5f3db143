// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/stiffening_plate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "physics/conversions.h"
#include "physics/plate/influence_table.h"
#include "physics/plate/reduction.h"

namespace dts::physics {
namespace {

constexpr int kMostCorrections = 40;
/// A load is applied in steps. The first step would store this fraction of its energy in stretching. With larger steps, Newton's method may
/// find another equilibrium of the plate: this happened for 1.4 % of loads up to 1300 N applied in one step.
constexpr double kGentleStretching = 0.02;
constexpr int kMostSteps = 64;
/// A change of more steps counts as another load, not as a movement: the calculation then starts from the flat plate.
constexpr double kMostStepsOfAMovement = 2.0;
/// Steps below this fraction of the amplitudes are not shortened: their energies differ only by rounding.
constexpr double kSafeChange = 1e-2;
constexpr double kShortestMove = 1e-3;
constexpr double kHopelessShift = 1e9;
constexpr double kAmplitudeTolerance = 1e-7;  ///< Relative to the amplitudes: below a nanometre.

using Amplitudes = ReducedPlate::Amplitudes;
using Pairs = ReducedPlate::Pairs;
using Square = Eigen::Matrix<double, ReducedPlate::kShapes, ReducedPlate::kShapes>;

/// Returns q_i q_j for i <= j.
Pairs pairs_of(const Amplitudes& q) {
  Pairs pairs;
  Eigen::Index pair = 0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    for (Eigen::Index j = i; j < q.size(); ++j) pairs[pair++] = q[i] * q[j];
  }
  return pairs;
}

/// Returns the symmetric matrix T with (derivative of the pairs by q)^T tension = T q.
Square tension_matrix(const Pairs& tension) {
  Square matrix;
  Eigen::Index pair = 0;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = i; j < matrix.cols(); ++j) {
      const double value = i == j ? 2.0 * tension[pair] : tension[pair];
      matrix(i, j) = value;
      matrix(j, i) = value;
      ++pair;
    }
  }
  return matrix;
}

/// Returns J^T stretching J, with J the derivative of the pairs by q. J has two entries per row: a dense product would cost six times as
/// much.
Square stretching_hessian(const ReducedPlate& plate, const Amplitudes& q) {
  constexpr int kShapes = ReducedPlate::kShapes;
  const auto entry = [&](int k, int j) { return k == j ? 2.0 * q[j] : q[j]; };
  Eigen::Matrix<double, ReducedPlate::kPairs, kShapes> half = Eigen::Matrix<double, ReducedPlate::kPairs, kShapes>::Zero();
  for (int k = 0; k < kShapes; ++k) {
    for (int j = 0; j < kShapes; ++j) half.col(k) += entry(k, j) * plate.stretching.col(ReducedPlate::pair(k, j));
  }
  Square hessian = Square::Zero();
  for (int k = 0; k < kShapes; ++k) {
    for (int j = 0; j < kShapes; ++j) hessian.row(k) += entry(k, j) * half.row(ReducedPlate::pair(k, j));
  }
  return hessian;
}

double energy(const ReducedPlate& plate, const Amplitudes& q, const Amplitudes& force) {
  const Pairs pairs = pairs_of(q);
  return 0.5 * q.squaredNorm() + 0.5 * pairs.dot(plate.stretching * pairs) - force.dot(q);
}

/// Returns the Newton step downhill. Where the energy curves downwards, adds as much of the identity as makes it curve upwards.
Amplitudes downhill(const Square& hessian, const Amplitudes& gradient) {
  for (double shift = 0.0; shift < kHopelessShift; shift = shift == 0.0 ? 1e-2 : 4.0 * shift) {
    const Eigen::LDLT<Square> factor(hessian + shift * Square::Identity());
    if (factor.isPositive() && factor.vectorD().minCoeff() > 0.0) return -factor.solve(gradient);
  }
  return -gradient;
}

/// Runs Newton's method at one load, with halved steps where the energy would rise. Ends in a minimum; from a near start in one or two
/// rounds.
void settle(const ReducedPlate& plate, const Amplitudes& force, Amplitudes& q) noexcept {
  for (int iteration = 0; iteration < kMostCorrections; ++iteration) {
    const Pairs tension = plate.stretching * pairs_of(q);
    const Square along = tension_matrix(tension);
    const Amplitudes gradient = q + along * q - force;
    const Amplitudes step = downhill(Square::Identity() + along + stretching_hessian(plate, q), gradient);
    if (!step.allFinite()) return;
    double part = 1.0;
    if (step.norm() > kSafeChange * q.norm()) {
      const double start = energy(plate, q, force);
      while (part > kShortestMove && energy(plate, q + part * step, force) > start) part *= 0.5;
    }
    q += part * step;
    if (step.norm() <= kAmplitudeTolerance * q.norm()) return;
  }
}

/// Returns the largest change of the generalised forces that `settle` follows safely.
double gentle_force(const ReducedPlate& plate) {
  const double stiffest = plate.stretching.diagonal().maxCoeff();
  return std::sqrt(kGentleStretching / stiffest);
}

}  // namespace

struct StiffeningPlate::Model {
  ReducedPlate reduced;
  double gentle_force = 0.0;
  InfluenceTable probes;
  GridFields shapes;  ///< m per unit amplitude.
  /// One per probe, m per unit amplitude of each shape.
  std::vector<Amplitudes> shape_at_probe;
};

StiffeningPlate::StiffeningPlate(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

core::Result<StiffeningPlate> StiffeningPlate::create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                      int divisions) {
  DTS_TRY_ASSIGN(auto table, InfluenceTable::create(plate, support, probes, divisions));
  DTS_TRY_ASSIGN(auto reduced, reduce(plate, support, divisions));
  auto model = std::make_shared<Model>(Model{reduced.plate, gentle_force(reduced.plate), std::move(table), std::move(reduced.shapes), {}});
  for (const Point& probe : probes) {
    Amplitudes shape_at_probe;
    for (std::size_t k = 0; k < ReducedPlate::kShapes; ++k) {
      shape_at_probe[static_cast<Eigen::Index>(k)] = model->shapes.mean(k, {.centre = probe});
    }
    model->shape_at_probe.push_back(shape_at_probe);
  }
  return StiffeningPlate(std::move(model));
}

std::size_t StiffeningPlate::probe_count() const noexcept { return model_->shape_at_probe.size(); }

StiffeningPlate::Footprint StiffeningPlate::footprint(const Patch& patch) const {
  Footprint result;
  for (std::size_t probe = 0; probe < probe_count(); ++probe) {
    result.probe_mm_per_n.push_back(model_->probes.under_patch_mm_per_n(probe, patch));
  }
  for (std::size_t k = 0; k < ReducedPlate::kShapes; ++k) result.shape_m_per_amplitude.push_back(model_->shapes.mean(k, patch));
  return result;
}

StiffeningPlate::State StiffeningPlate::flat() const {
  const std::vector<double> zeros(ReducedPlate::kShapes, 0.0);
  return {.amplitude = zeros, .force = zeros};
}

void StiffeningPlate::deflect(std::span<const Footprint> footprints, std::span<const double> force_n, State& state,
                              std::span<double> deflection_mm) const noexcept {
  Amplitudes force = Amplitudes::Zero();
  std::ranges::fill(deflection_mm, 0.0);
  for (std::size_t patch = 0; patch < footprints.size(); ++patch) {
    const Footprint& footprint = footprints[patch];
    force += force_n[patch] * Eigen::Map<const Amplitudes>(footprint.shape_m_per_amplitude.data());
    for (std::size_t probe = 0; probe < deflection_mm.size(); ++probe)
      deflection_mm[probe] += force_n[patch] * footprint.probe_mm_per_n[probe];
  }
  Eigen::Map<Amplitudes> kept(state.amplitude.data());
  Eigen::Map<Amplitudes> kept_force(state.force.data());
  Amplitudes q = kept;
  Amplitudes from = kept_force;
  const bool is_movement = (force - from).norm() <= kMostStepsOfAMovement * model_->gentle_force;
  if (!is_movement || !force.allFinite()) {  // a NaN must not stay in the state
    q.setZero();
    from.setZero();
  }
  const Amplitudes change = force - from;
  const double steps = std::clamp(std::ceil(change.norm() / model_->gentle_force), 1.0, static_cast<double>(kMostSteps));
  for (double step = 1.0; step <= steps; step += 1.0) settle(model_->reduced, from + (step / steps) * change, q);
  if (!force.allFinite()) force.setZero();
  kept = q;
  kept_force = force;
  const Amplitudes correction = kMillimetresPerMetre * (q - force);  // a linear plate has the amplitudes `force`
  for (std::size_t probe = 0; probe < deflection_mm.size(); ++probe) deflection_mm[probe] += correction.dot(model_->shape_at_probe[probe]);
}

std::vector<double> StiffeningPlate::deflections_mm(const Patch& patch, core::Newtons force) const {
  const std::array footprints{footprint(patch)};
  const std::array forces{force.value};
  State state = flat();
  std::vector<double> result(probe_count());
  deflect(footprints, forces, state, result);
  return result;
}

}  // namespace dts::physics
