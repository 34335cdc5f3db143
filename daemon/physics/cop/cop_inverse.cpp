// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_inverse.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "physics/cop/cop_estimator.h"
#include "physics/plate/stiffening_plate.h"

namespace dts::physics {
namespace {

/// The first guess uses this many positions per side.
constexpr int kCoarse = 12;
/// The linear table is bilinear between its nodes, so any short difference equals the slope.
constexpr double kDifferenceMm = 0.05;
constexpr double kDifferencePart = 1e-4;
constexpr double kGoodStepMm = 1e-9;
/// Levenberg's damping: the value after the first failed step, and the limit above which no further step is tried.
constexpr double kFirstDamping = 1e-3;
constexpr double kHopeless = 1e9;

/// Steps of the stiffening table over a side and over the load.
constexpr std::size_t kSideSteps = 20;
constexpr std::size_t kLoadSteps = 16;

/// Catmull-Rom: four neighbouring nodes and their weights. Beyond the ends the table continues linearly. Before the first load it continues
/// symmetrically, because stiffening does not depend on the direction of the load.
struct Neighbours {
  std::array<std::size_t, 4> node{};
  std::array<double, 4> weight{};

  Neighbours(double position, std::size_t steps, bool is_mirrored) noexcept {
    const auto last = static_cast<double>(steps);
    const double inside = position > 0.0 ? std::min(position, last) : 0.0;
    const std::size_t cell = std::min(static_cast<std::size_t>(inside), steps - 1);
    const double t = inside - static_cast<double>(cell);
    weight = {0.5 * t * (-1.0 + t * (2.0 - t)), 1.0 + t * t * (1.5 * t - 2.5), 0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
              0.5 * t * t * (t - 1.0)};
    node = {cell == 0 ? 0 : cell - 1, cell, cell + 1, std::min(cell + 2, steps)};
    if (cell == 0) {
      weight[2] += is_mirrored ? weight[0] : -weight[0];
      weight[1] += is_mirrored ? 0.0 : 2.0 * weight[0];
      weight[0] = 0.0;
    }
    if (cell + 1 == steps) {
      weight[2] += 2.0 * weight[3];
      weight[1] -= weight[3];
      weight[3] = 0.0;
    }
  }
};

}  // namespace

core::Result<std::shared_ptr<const CopInverse>> CopInverse::create(const ModelForm& form) {
  DTS_TRY_ASSIGN(const auto table, InfluenceTable::create(form.plate, form.support, form.sensors));
  std::shared_ptr<CopInverse> inverse(new CopInverse(table, form));
  if (form.behaviour == PlateBehaviour::Stiffening) {
    DTS_TRY(inverse->tabulate_stiffening(form));
  }
  return std::shared_ptr<const CopInverse>(std::move(inverse));
}

CopInverse::CopInverse(InfluenceTable table, const ModelForm& form)
    : table_(std::move(table)), a_mm_(form.plate.a.value), b_mm_(form.plate.b.value), heaviest_n_(form.heaviest.value) {}

core::Status CopInverse::tabulate_stiffening(const ModelForm& form) {
  DTS_TRY_ASSIGN(const auto plate, StiffeningPlate::create(form.plate, form.support, form.sensors));
  const std::size_t sensors = form.sensors.size();
  constexpr std::size_t kNodes = (kSideSteps + 1) * (kSideSteps + 1);
  stiffening_mm_per_n_.assign((kLoadSteps + 1) * kNodes * sensors, 0.0);
  std::vector<double> deflection_mm(sensors);
  for (std::size_t node = 0; node < kNodes; ++node) {
    const Point position{{a_mm_ * static_cast<double>(node % (kSideSteps + 1)) / kSideSteps},
                         {b_mm_ * static_cast<double>(node / (kSideSteps + 1)) / kSideSteps}};
    const auto footprint = plate.footprint({position, {}, {}});
    auto state = plate.flat();
    for (std::size_t step = 1; step <= kLoadSteps; ++step) {  // light to heavy: each solution starts from the previous one
      const double load_n = heaviest_n_ * static_cast<double>(step) / kLoadSteps;
      plate.deflect(std::span(&footprint, 1), std::span(&load_n, 1), state, deflection_mm);
      for (std::size_t k = 0; k < sensors; ++k) {
        stiffening_mm_per_n_[(step * kNodes + node) * sensors + k] = deflection_mm[k] / load_n - footprint.probe_mm_per_n[k];
      }
    }
  }
  return {};
}

void CopInverse::influence(const PointLoad& load, std::span<double> mm_per_n) const noexcept {
  for (std::size_t k = 0; k < mm_per_n.size(); ++k) mm_per_n[k] = table_.at_point_mm_per_n(k, {{load.x_mm}, {load.y_mm}});
  if (stiffening_mm_per_n_.empty()) return;
  const Neighbours x(load.x_mm / a_mm_ * kSideSteps, kSideSteps, false);
  const Neighbours y(load.y_mm / b_mm_ * kSideSteps, kSideSteps, false);
  const Neighbours n(load.load_n / heaviest_n_ * kLoadSteps, kLoadSteps, true);
  for (std::size_t l = 0; l < 4; ++l) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t i = 0; i < 4; ++i) {
        const double weight = n.weight[l] * y.weight[j] * x.weight[i];
        const std::size_t node = (n.node[l] * (kSideSteps + 1) + y.node[j]) * (kSideSteps + 1) + x.node[i];
        for (std::size_t k = 0; k < mm_per_n.size(); ++k) mm_per_n[k] += weight * stiffening_mm_per_n_[node * mm_per_n.size() + k];
      }
    }
  }
}

double CopInverse::misfit(std::span<const double> deflection_mm, const PointLoad& load) const noexcept {
  std::array<double, kMaxCopSensors> buffer;
  const std::span<double> mm_per_n(buffer.data(), deflection_mm.size());
  influence(load, mm_per_n);
  double squares = 0.0;
  for (std::size_t k = 0; k < deflection_mm.size(); ++k) squares += std::pow(deflection_mm[k] - load.load_n * mm_per_n[k], 2);
  return squares;
}

double CopInverse::best_load_n(std::span<const double> deflection_mm, const PointLoad& load) const noexcept {
  std::array<double, kMaxCopSensors> buffer;
  const std::span<double> mm_per_n(buffer.data(), deflection_mm.size());
  influence(load, mm_per_n);
  double product = 0.0;
  double square = 0.0;
  for (std::size_t k = 0; k < deflection_mm.size(); ++k) {
    product += mm_per_n[k] * deflection_mm[k];
    square += mm_per_n[k] * mm_per_n[k];
  }
  return product / square;
}

CopInverse::PointLoad CopInverse::first_guess(std::span<const double> deflection_mm) const noexcept {
  PointLoad best{0.5 * a_mm_, 0.5 * b_mm_, 0.0};
  double smallest = misfit(deflection_mm, best);
  for (int place = 0; place < kCoarse * kCoarse; ++place) {
    PointLoad here{a_mm_ * (place % kCoarse + 0.5) / kCoarse, b_mm_ * (place / kCoarse + 0.5) / kCoarse, 0.0};
    double product = 0.0;
    double square = 0.0;
    for (std::size_t k = 0; k < deflection_mm.size(); ++k) {  // linear theory gives the best load directly
      const double mm_per_n = table_.at_point_mm_per_n(k, {{here.x_mm}, {here.y_mm}});
      product += mm_per_n * deflection_mm[k];
      square += mm_per_n * mm_per_n;
    }
    here.load_n = product / square;
    double squares = 0.0;
    for (std::size_t k = 0; k < deflection_mm.size(); ++k) {
      squares += std::pow(deflection_mm[k] - here.load_n * table_.at_point_mm_per_n(k, {{here.x_mm}, {here.y_mm}}), 2);
    }
    if (!(here.load_n > 0.0 && squares < smallest)) continue;
    smallest = squares;
    best = here;
  }
  return best;
}

CopInverse::PointLoad CopInverse::improve(std::span<const double> deflection_mm, const PointLoad& from, double& damping) const noexcept {
  using Slopes = std::array<double, kMaxCopSensors>;
  const std::size_t n = deflection_mm.size();
  const double load_step_n = kDifferencePart * std::max(std::abs(from.load_n), 1.0);
  const std::array<PointLoad, 3> steps{PointLoad{kDifferenceMm, 0.0, 0.0}, PointLoad{0.0, kDifferenceMm, 0.0},
                                       PointLoad{0.0, 0.0, load_step_n}};
  std::array<Slopes, 3> slopes;
  Slopes here;
  Slopes after;
  Slopes before;
  influence(from, {here.data(), n});
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const auto& [dx_mm, dy_mm, dload_n] = steps[s];
    influence({from.x_mm + dx_mm, from.y_mm + dy_mm, from.load_n + dload_n}, {after.data(), n});
    influence({from.x_mm - dx_mm, from.y_mm - dy_mm, from.load_n - dload_n}, {before.data(), n});
    for (std::size_t k = 0; k < n; ++k) {
      slopes[s][k] = ((from.load_n + dload_n) * after[k] - (from.load_n - dload_n) * before[k]) / (2.0 * (dx_mm + dy_mm + dload_n));
    }
  }
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Vector3d row(slopes[0][k], slopes[1][k], slopes[2][k]);
    normal += row * row.transpose();
    right += row * (deflection_mm[k] - from.load_n * here[k]);
  }
  normal.diagonal().head<2>() *= 1.0 + damping;
  const Eigen::Vector3d step = normal.ldlt().solve(right);
  PointLoad next{std::clamp(from.x_mm + step[0], 0.0, a_mm_), std::clamp(from.y_mm + step[1], 0.0, b_mm_), from.load_n + step[2]};
  next.load_n = best_load_n(deflection_mm, next);
  const bool is_better = misfit(deflection_mm, next) < misfit(deflection_mm, from);
  damping = is_better ? 0.1 * damping : std::max(10.0 * damping, kFirstDamping);
  return is_better ? next : from;
}

CopInverse::PointLoad CopInverse::solve(std::span<const double> deflection_mm) const noexcept {
  PointLoad best = first_guess(deflection_mm);
  double damping = 0.0;
  for (int iteration = 0; iteration < kMaxIterations && damping < kHopeless; ++iteration) {
    const PointLoad next = improve(deflection_mm, best, damping);
    const double step_mm = std::hypot(next.x_mm - best.x_mm, next.y_mm - best.y_mm);
    best = next;
    if (step_mm > 0.0 && step_mm < kGoodStepMm) break;
  }
  return best;
}

}  // namespace dts::physics
