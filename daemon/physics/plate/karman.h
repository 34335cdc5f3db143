// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "core/result.h"
#include "physics/plate/supported_plate.h"

// Internal to `solve` (Eigen in its interface): a plate that stretches as it bends.

namespace dts::physics {

/// A bent and stretched plate in equilibrium.
struct KarmanState {
  Eigen::VectorXd dofs;        ///< Of the deflection, m.
  Eigen::VectorXd membrane_n;  ///< Nodal forces that the stretched middle plane carries.
  int load_steps = 0;
  int newton_iterations = 0;
};

/// Solves the von Karman plate: membrane strains u_x + w_x^2/2, v_y + w_y^2/2, u_y + v_x + w_x w_y. In-plane displacements are bilinear in
/// each cell and free at every edge and support: only the three rigid motions are fixed. Applies Newton's method with line search to the
/// potential energy, starting from the linear solution. If that does not converge, applies the load in smaller steps. Calls
/// `report_progress` with 0..1. Fails with Failed if even a step of 1/64 of the load does not converge.
[[nodiscard]] core::Result<KarmanState> bend_and_stretch(const SupportedPlate& supported, const Plate& plate,
                                                         const Eigen::VectorXd& force_n,
                                                         const std::function<void(double)>& report_progress);

}  // namespace dts::physics
