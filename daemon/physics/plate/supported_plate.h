// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

#include "core/result.h"
#include "physics/plate/discretisation.h"

// Internal to the plate solvers (Eigen in its interface): a discretisation with its supports.

namespace dts::physics {

/// The four point supports of SupportKind::Corner: (-,-), (+,-), (-,+), (+,+).
[[nodiscard]] std::array<Point, 4> corner_supports(const Plate& plate, core::Millimetres inset);

/// Stiffness, held degrees of freedom and one factorisation, used for any number of loads. Immutable.
class SupportedPlate {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// The inputs must have passed the checks of plate.h. Fails with InvalidArgument if the supports do not hold the plate.
  [[nodiscard]] static core::Result<SupportedPlate> create(std::unique_ptr<const Discretisation> discretisation, const Plate& plate,
                                                           const Support& support);

  [[nodiscard]] const Discretisation& discretisation() const noexcept { return *discretisation_; }
  [[nodiscard]] const std::shared_ptr<const Discretisation>& shared_discretisation() const noexcept { return discretisation_; }
  /// Returns the degrees of freedom, in m, under nodal forces, in N.
  [[nodiscard]] Eigen::VectorXd bend(const Eigen::VectorXd& force_n) const;
  /// Returns the forces on the supports in the order of PlateSolution::reactions_n, from the forces that the bent plate does not balance.
  [[nodiscard]] std::vector<double> reactions_n(const Eigen::VectorXd& unbalanced_n) const;
  /// Returns the nodal forces that bend the free plate to `dofs`.
  [[nodiscard]] Eigen::VectorXd forces_n(const Eigen::VectorXd& dofs) const { return free_stiffness_ * dofs; }
  /// Includes the springs of the supports; a held degree of freedom has only its diagonal entry.
  [[nodiscard]] const Matrix& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] bool is_held(Eigen::Index dof) const { return is_held_[static_cast<std::size_t>(dof)]; }
  /// Returns a load on all degrees of freedom, as `reactions_n` needs: a held one transfers its share directly to the support.
  [[nodiscard]] Eigen::VectorXd whole(const Weights& weights) const;
  /// Returns the load without the held degrees of freedom, as `bend` needs.
  [[nodiscard]] Eigen::VectorXd vector(const Weights& weights) const;
  [[nodiscard]] static double read(const Eigen::VectorXd& dofs, const Weights& weights);

 private:
  SupportedPlate() = default;
  void hold(const Plate& plate);

  std::shared_ptr<const Discretisation> discretisation_;
  Support support_;
  std::vector<Weights> point_supports_;
  std::vector<bool> is_held_;
  Matrix free_stiffness_;
  Matrix stiffness_;
  std::shared_ptr<const Eigen::SimplicialLDLT<Matrix>> factor_;
};

}  // namespace dts::physics
