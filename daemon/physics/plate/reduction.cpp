// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/reduction.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "physics/plate/membrane.h"
#include "physics/plate/supported_plate.h"

namespace dts::physics {
namespace {

/// Number of loads per side from which the shapes are computed.
constexpr int kLoadsPerSide = 7;
/// Stretching is smoother than bending: half the divisions are enough, and reduce the time for a plate to a fifth.
constexpr int kMembraneCoarsening = 2;

/// Columns: degrees of freedom of each shape, scaled to unit bending energy.
core::Result<Eigen::MatrixXd> find_shapes(const SupportedPlate& supported, const Plate& plate) {
  const Discretisation& discretisation = supported.discretisation();
  Eigen::MatrixXd deflections(discretisation.dof_count(), kLoadsPerSide * kLoadsPerSide);
  Eigen::MatrixXd forces(deflections.rows(), deflections.cols());
  for (int k = 0; k < deflections.cols(); ++k) {
    const double x = (k % kLoadsPerSide + 0.5) / kLoadsPerSide;
    const double y = (k / kLoadsPerSide + 0.5) / kLoadsPerSide;
    forces.col(k) = supported.vector(discretisation.force({.centre = {plate.a * x, plate.b * y}}));
    deflections.col(k) = supported.bend(forces.col(k));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(forces.transpose() * deflections);
  const auto energies = modes.eigenvalues().tail<ReducedPlate::kShapes>();
  if (modes.info() != Eigen::Success || !(energies.minCoeff() > 0.0)) {
    return core::fail(core::ErrorCode::Internal, "the shapes of the plate are not independent");
  }
  return deflections * modes.eigenvectors().rightCols<ReducedPlate::kShapes>() * energies.cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Strains of every point of every cell, three rows each.
class Stretching {
 public:
  Stretching(const Discretisation& discretisation, const Plate& plate)
      : discretisation_(discretisation), membrane_(discretisation, plate), cells_(discretisation.grid().divisions) {
    factorise();
  }

  /// Returns the energy of each pair with each other pair, with eliminated in-plane displacements. `shapes` must be on this grid.
  [[nodiscard]] Eigen::MatrixXd energies(const Eigen::MatrixXd& shapes) const {
    const Eigen::MatrixXd strains = pair_strains(shapes);
    Eigen::MatrixXd tensions = strains;
    for (Eigen::Index row = 0; row < tensions.rows(); row += 3) {
      tensions.middleRows<3>(row) = area_m2() * membrane_.elasticity() * strains.middleRows<3>(row);
    }
    const Eigen::MatrixXd pull = in_plane_.transpose() * tensions;  // in-plane nodal forces of each pair
    return strains.transpose() * tensions - pull.transpose() * factor_.solve(pull);
  }

 private:
  [[nodiscard]] double area_m2() const { return membrane_.points().front().area_m2; }
  [[nodiscard]] Eigen::Index row_count() const { return 3 * static_cast<Eigen::Index>(membrane_.points().size()) * cells_ * cells_; }

  template <class Visit>
  void for_each_point(Visit visit) const {
    Eigen::Index row = 0;
    for (int j = 0; j < cells_; ++j) {
      for (int i = 0; i < cells_; ++i) {
        for (const auto& point : membrane_.points()) {
          visit(i, j, point, row);
          row += 3;
        }
      }
    }
  }

  void factorise() {
    std::vector<Eigen::Triplet<double>> strain;
    const auto pinned = membrane_.pinned_dofs();
    for_each_point([&](int i, int j, const Membrane::Point& point, Eigen::Index row) {
      const auto dofs = membrane_.in_plane_dofs(i, j);
      for (int component = 0; component < 3; ++component) {
        for (int k = 0; k < 8; ++k) {
          const int dof = dofs[static_cast<std::size_t>(k)];
          if (std::ranges::find(pinned, dof) == pinned.end()) strain.emplace_back(row + component, dof, point.in_plane(component, k));
        }
      }
    });
    in_plane_.resize(row_count(), membrane_.in_plane_count());
    in_plane_.setFromTriplets(strain.begin(), strain.end());
    std::vector<Eigen::Triplet<double>> elasticity;
    for (Eigen::Index row = 0; row < row_count(); row += 3) {
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) elasticity.emplace_back(row + a, row + b, area_m2() * membrane_.elasticity()(a, b));
      }
    }
    SupportedPlate::Matrix elastic(row_count(), row_count());
    elastic.setFromTriplets(elasticity.begin(), elasticity.end());
    SupportedPlate::Matrix stiffness = SupportedPlate::Matrix(in_plane_.transpose()) * elastic * in_plane_;
    for (const int dof : pinned) stiffness.coeffRef(dof, dof) = membrane_.elasticity()(0, 0);
    factor_.compute(stiffness);
  }

  [[nodiscard]] Eigen::MatrixXd pair_strains(const Eigen::MatrixXd& shapes) const {
    Eigen::MatrixXd strains(row_count(), ReducedPlate::kPairs);
    for_each_point([&](int i, int j, const Membrane::Point& point, Eigen::Index row) {
      const auto dofs = discretisation_.cell_dofs(i, j);
      Eigen::MatrixXd cell(dofs.size(), shapes.cols());
      for (std::size_t k = 0; k < dofs.size(); ++k) cell.row(static_cast<Eigen::Index>(k)) = shapes.row(dofs[k]);
      const Eigen::RowVectorXd x = point.slope_x * cell;
      const Eigen::RowVectorXd y = point.slope_y * cell;
      Eigen::Index pair = 0;
      for (Eigen::Index a = 0; a < x.size(); ++a) {
        for (Eigen::Index b = a; b < x.size(); ++b) {
          const double half = a == b ? 0.5 : 1.0;
          strains.col(pair++).segment<3>(row) << half * x[a] * x[b], half * y[a] * y[b], half * (x[a] * y[b] + x[b] * y[a]);
        }
      }
    });
    return strains;
  }

  const Discretisation& discretisation_;
  Membrane membrane_;
  int cells_;
  SupportedPlate::Matrix in_plane_;
  Eigen::SimplicialLDLT<SupportedPlate::Matrix> factor_;
};

/// Returns the shapes at the nodes of a coarser grid.
Eigen::MatrixXd sample(const Eigen::MatrixXd& shapes, const Discretisation& fine, const Discretisation& coarse) {
  const Grid& grid = coarse.grid();
  Eigen::MatrixXd sampled(grid.node_count(), shapes.cols());
  for (int j = 0; j <= grid.divisions; ++j) {
    for (int i = 0; i <= grid.divisions; ++i) {
      const auto weights = fine.reading({{i * grid.dx_mm()}, {j * grid.dy_mm()}});
      for (Eigen::Index k = 0; k < shapes.cols(); ++k) sampled(grid.node(i, j), k) = SupportedPlate::read(shapes.col(k), weights);
    }
  }
  return sampled;
}

}  // namespace

core::Result<Reduction> reduce(const Plate& plate, const Support& support, int divisions) {
  DTS_TRY_ASSIGN(const auto supported, SupportedPlate::create(make_fdm(plate, support, divisions), plate, support));
  DTS_TRY_ASSIGN(const auto shapes, find_shapes(supported, plate));
  const auto coarse = make_fdm(plate, support, std::max(divisions / kMembraneCoarsening, Grid::kMinDivisions));
  const Stretching stretching(*coarse, plate);
  Reduction reduction{.plate = {stretching.energies(sample(shapes, supported.discretisation(), *coarse))},
                      .shapes = GridFields(supported.discretisation().grid())};
  for (const auto& shape : shapes.colwise()) reduction.shapes.add({shape.begin(), shape.end()});
  return reduction;
}

}  // namespace dts::physics
