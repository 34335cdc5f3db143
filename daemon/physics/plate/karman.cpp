// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/karman.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "physics/plate/membrane.h"

namespace dts::physics {
namespace {

constexpr double kSmallestStep = 1.0 / 64.0;
constexpr int kMostIterations = 30;
/// Relative to the deflections. Newton converges quadratically, so the next step would be at rounding level.
constexpr double kDeflectionTolerance = 1e-7;
constexpr double kShortestLine = 1.0 / 64.0;
/// Steps below this fraction of the deflections are not shortened: Newton is safe there, and energies differ only by rounding.
constexpr double kSafeStep = 1e-2;

/// The plate's potential energy over deflections (first) and in-plane displacements (after them), with gradient and Hessian.
class Energy {
 public:
  Energy(const SupportedPlate& supported, const Plate& plate)
      : supported_(supported), membrane_(supported.discretisation(), plate), bending_count_(supported.discretisation().dof_count()) {
    const auto& matrix = supported.stiffness();
    for (int column = 0; column < matrix.outerSize(); ++column) {
      for (SupportedPlate::Matrix::InnerIterator entry(matrix, column); entry; ++entry) {
        bending_.emplace_back(static_cast<int>(entry.row()), column, entry.value());
      }
    }
    is_held_.assign(static_cast<std::size_t>(size()), false);
    for (int dof = 0; dof < bending_count_; ++dof) is_held_[static_cast<std::size_t>(dof)] = supported.is_held(dof);
    for (const int dof : membrane_.pinned_dofs()) {
      is_held_[static_cast<std::size_t>(bending_count_ + dof)] = true;
      bending_.emplace_back(bending_count_ + dof, bending_count_ + dof, membrane_.elasticity()(0, 0));
    }
  }

  [[nodiscard]] int size() const { return bending_count_ + membrane_.in_plane_count(); }
  [[nodiscard]] int bending_count() const { return bending_count_; }

  [[nodiscard]] double value(const Eigen::VectorXd& unknowns, const Eigen::VectorXd& force) const {
    const auto bent = unknowns.head(bending_count_);
    double energy = 0.5 * bent.dot(supported_.stiffness() * bent) - force.dot(bent);
    for_each_cell(unknowns, [&](const std::vector<int>&, const Eigen::VectorXd& cell) {
      for (const auto& point : membrane_.points()) {
        const auto [slope_x, slope_y, strain] = strain_at(point, cell);
        energy += 0.5 * point.area_m2 * strain.dot(membrane_.elasticity() * strain);
      }
    });
    return energy;
  }

  /// Returns the nodal forces of the stretched plate on all unknowns; zero where held.
  [[nodiscard]] Eigen::VectorXd membrane_forces(const Eigen::VectorXd& unknowns) const {
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(size());
    for_each_cell(unknowns, [&](const std::vector<int>& dofs, const Eigen::VectorXd& cell) {
      Eigen::VectorXd of_cell = Eigen::VectorXd::Zero(cell.size());
      for (const auto& point : membrane_.points()) {
        const auto jacobian = strain_change(point, cell);
        of_cell += point.area_m2 * jacobian.transpose() * (membrane_.elasticity() * strain_at(point, cell).strain);
      }
      for (std::size_t k = 0; k < dofs.size(); ++k) forces[dofs[k]] += of_cell[static_cast<Eigen::Index>(k)];
    });
    return forces;
  }

  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& unknowns, const Eigen::VectorXd& force) const {
    Eigen::VectorXd result = membrane_forces(unknowns);
    result.head(bending_count_) += supported_.stiffness() * unknowns.head(bending_count_) - force;
    for (int dof = 0; dof < size(); ++dof) {
      if (is_held_[static_cast<std::size_t>(dof)]) result[dof] = 0.0;
    }
    return result;
  }

  [[nodiscard]] SupportedPlate::Matrix hessian(const Eigen::VectorXd& unknowns) const {
    auto triplets = bending_;
    for_each_cell(unknowns, [&](const std::vector<int>& dofs, const Eigen::VectorXd& cell) {
      const Eigen::MatrixXd of_cell = cell_hessian(cell);
      for (std::size_t a = 0; a < dofs.size(); ++a) {
        if (is_held_[static_cast<std::size_t>(dofs[a])]) continue;
        for (std::size_t b = 0; b < dofs.size(); ++b) {  // one triangle is enough for the factorisation
          if (dofs[a] < dofs[b] || is_held_[static_cast<std::size_t>(dofs[b])]) continue;
          triplets.emplace_back(dofs[a], dofs[b], of_cell(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
        }
      }
    });
    SupportedPlate::Matrix matrix(size(), size());
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
  }

 private:
  struct LocalStrain {
    double slope_x;
    double slope_y;
    Membrane::Strain strain;
  };

  [[nodiscard]] static LocalStrain strain_at(const Membrane::Point& point, const Eigen::VectorXd& cell) {
    const auto bent = cell.head(point.slope_x.size());
    const double slope_x = point.slope_x.dot(bent);
    const double slope_y = point.slope_y.dot(bent);
    Membrane::Strain strain = point.in_plane * cell.tail<8>();
    strain += Membrane::Strain(0.5 * slope_x * slope_x, 0.5 * slope_y * slope_y, slope_x * slope_y);
    return {slope_x, slope_y, strain};
  }

  /// Returns the derivative of the strain by the unknowns of the cell.
  [[nodiscard]] static Eigen::Matrix<double, 3, Eigen::Dynamic> strain_change(const Membrane::Point& point, const Eigen::VectorXd& cell) {
    const auto [slope_x, slope_y, strain] = strain_at(point, cell);
    Eigen::Matrix<double, 3, Eigen::Dynamic> change(3, cell.size());
    auto bending = change.leftCols(point.slope_x.size());
    bending.row(0) = slope_x * point.slope_x;
    bending.row(1) = slope_y * point.slope_y;
    bending.row(2) = slope_x * point.slope_y + slope_y * point.slope_x;
    change.rightCols<8>() = point.in_plane;
    return change;
  }

  [[nodiscard]] Eigen::MatrixXd cell_hessian(const Eigen::VectorXd& cell) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(cell.size(), cell.size());
    for (const auto& point : membrane_.points()) {
      const auto change = strain_change(point, cell);
      const Eigen::Vector3d tension = membrane_.elasticity() * strain_at(point, cell).strain;
      result.noalias() += point.area_m2 * change.transpose() * (membrane_.elasticity() * change);
      const auto count = point.slope_x.size();
      result.topLeftCorner(count, count) +=
          point.area_m2 * (tension[0] * point.slope_x.transpose() * point.slope_x + tension[1] * point.slope_y.transpose() * point.slope_y +
                           tension[2] * (point.slope_x.transpose() * point.slope_y + point.slope_y.transpose() * point.slope_x));
    }
    return result;
  }

  template <class Visit>
  void for_each_cell(const Eigen::VectorXd& unknowns, Visit visit) const {
    const auto& discretisation = supported_.discretisation();
    const int cells = discretisation.grid().divisions;
    Eigen::VectorXd values;
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        std::vector<int> dofs = discretisation.cell_dofs(i, j);
        for (const int dof : membrane_.in_plane_dofs(i, j)) dofs.push_back(bending_count_ + dof);
        values.resize(static_cast<Eigen::Index>(dofs.size()));
        for (std::size_t k = 0; k < dofs.size(); ++k) values[static_cast<Eigen::Index>(k)] = unknowns[dofs[k]];
        visit(dofs, values);
      }
    }
  }

  const SupportedPlate& supported_;
  Membrane membrane_;
  int bending_count_;
  std::vector<Eigen::Triplet<double>> bending_;
  std::vector<bool> is_held_;
};

/// Newton's method at one load. `unknowns` keeps the last iterate; returns true if it converged.
class Newton {
 public:
  explicit Newton(const Energy& energy) : energy_(energy) {}

  [[nodiscard]] int iterations() const { return iterations_; }

  /// Calls `report` with the progress of convergence, 0..1.
  bool run(Eigen::VectorXd& unknowns, const Eigen::VectorXd& force, const std::function<void(double)>& report) {
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      ++iterations_;
      const auto hessian = energy_.hessian(unknowns);
      if (!is_analysed_) factor_.analyzePattern(hessian);
      is_analysed_ = true;
      factor_.factorize(hessian);
      if (factor_.info() != Eigen::Success) return false;
      const Eigen::VectorXd gradient = energy_.gradient(unknowns, force);
      const Eigen::VectorXd step = -factor_.solve(gradient);
      if (!step.allFinite()) return false;
      if (step.squaredNorm() == 0.0) return true;  // no bending: the load is directly on the supports, or its sum is zero
      const double length = step.head(energy_.bending_count()).norm() / unknowns.head(energy_.bending_count()).norm();
      const double part = length <= kSafeStep ? 1.0 : line_search(unknowns, step, force, gradient.dot(step));
      if (part == 0.0) return false;
      unknowns += part * step;
      report(std::clamp(std::log(length) / std::log(kDeflectionTolerance), 0.0, 1.0));
      if (length <= kDeflectionTolerance) return true;
    }
    return false;
  }

 private:
  /// Returns the longest of 1, 1/2, 1/4 ... of the step that lowers the energy; 0: none.
  [[nodiscard]] double line_search(const Eigen::VectorXd& from, const Eigen::VectorXd& step, const Eigen::VectorXd& force,
                                   double descent) const {
    const double start = energy_.value(from, force);
    for (double part = 1.0; part >= kShortestLine; part *= 0.5) {
      if (energy_.value(from + part * step, force) <= start + 1e-4 * part * std::min(descent, 0.0)) return part;
    }
    return 0.0;
  }

  const Energy& energy_;
  Eigen::SimplicialLDLT<SupportedPlate::Matrix> factor_;
  bool is_analysed_ = false;
  int iterations_ = 0;
};

}  // namespace

core::Result<KarmanState> bend_and_stretch(const SupportedPlate& supported, const Plate& plate, const Eigen::VectorXd& force_n,
                                           const std::function<void(double)>& report_progress) {
  const Energy energy(supported, plate);
  Newton newton(energy);
  Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(energy.size());
  KarmanState state;
  double done = 0.0;
  double step = 1.0;
  double furthest = 0.0;
  while (done < 1.0) {
    const double wanted = std::min(1.0, done + step);
    Eigen::VectorXd attempt = unknowns;
    if (done == 0.0) attempt.head(energy.bending_count()) = wanted * supported.bend(force_n);
    const auto report = [&](double converged) {
      furthest = std::max(furthest, done + converged * (wanted - done));  // the first steps may lead away
      if (report_progress) report_progress(furthest);
    };
    if (newton.run(attempt, wanted * force_n, report)) {
      unknowns = std::move(attempt);
      done = wanted;
      ++state.load_steps;
      continue;
    }
    step *= 0.5;
    if (step < kSmallestStep) {
      return core::fail(core::ErrorCode::Failed,
                        "the non-linear solution does not converge beyond " + std::to_string(100.0 * done) + " % of the load",
                        "lower the load, or use more divisions");
    }
  }
  state.newton_iterations = newton.iterations();
  state.dofs = unknowns.head(energy.bending_count());
  state.membrane_n = energy.membrane_forces(unknowns).head(energy.bending_count());
  return state;
}

}  // namespace dts::physics
