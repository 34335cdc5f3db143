// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

#include "core/result.h"
#include "physics/plate/discretisation.h"

// Inside of the plate's solvers (Eigen in its interface): a discretisation held by its supports.

namespace dts::physics {

/// The four point supports of SupportKind::Corner: (-,-), (+,-), (-,+), (+,+).
[[nodiscard]] std::array<Point, 4> corner_supports(const Plate& plate, core::Millimetres inset);

/// Stiffness, held degrees of freedom and one factorisation, for any number of loads. Immutable.
class SupportedPlate {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// The inputs have passed the checks of plate.h. Fails with InvalidArgument when the supports do not hold the plate.
  [[nodiscard]] static core::Result<SupportedPlate> create(std::unique_ptr<const Discretisation> discretisation, const Plate& plate,
                                                           const Support& support);

  [[nodiscard]] const Discretisation& discretisation() const noexcept { return *discretisation_; }
  [[nodiscard]] const std::shared_ptr<const Discretisation>& shared_discretisation() const noexcept { return discretisation_; }
  /// Degrees of freedom, in m, under nodal forces, in N.
  [[nodiscard]] Eigen::VectorXd bend(const Eigen::VectorXd& force_n) const;
  /// What the supports carry, as PlateSolution::reactions_n, from the forces that the bent plate leaves to them.
  [[nodiscard]] std::vector<double> reactions_n(const Eigen::VectorXd& unbalanced_n) const;
  /// Nodal forces that bend the free plate to `dofs`.
  [[nodiscard]] Eigen::VectorXd forces_n(const Eigen::VectorXd& dofs) const { return free_stiffness_ * dofs; }
  /// With the supports' springs; held degrees of freedom have a lone entry on the diagonal.
  [[nodiscard]] const Matrix& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] bool is_held(Eigen::Index dof) const { return is_held_[static_cast<std::size_t>(dof)]; }
  /// A load on all degrees of freedom: what `reactions_n` needs, since the held ones carry their share straight into the support.
  [[nodiscard]] Eigen::VectorXd whole(const Weights& weights) const;
  /// The same without the held ones: what `bend` needs.
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
