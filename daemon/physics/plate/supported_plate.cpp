// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/supported_plate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "physics/conversions.h"

namespace dts::physics {
namespace {

/// Stiffness of a point support in units of the plate's own D/l^2. From 1e3 to 1e8 the deflections change by 0.002 % (plate-model section
/// 2); with 1e6, ten digits remain for the plate itself.
constexpr double kSupportStiffness = 1e6;

/// Largest deflection under 1 N that can be bending, in units of a b / D (a corner-supported plate has 0.04 at its centre).
constexpr double kLargestCompliance = 100.0;

SupportedPlate::Matrix assemble(int size, const std::vector<StiffnessEntry>& entries) {
  SupportedPlate::Matrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

tl::unexpected<core::Error> plate_tips(const Support& support) {
  return core::fail(core::ErrorCode::InvalidArgument,
                    "support inset " + std::to_string(support.inset.value) + " mm puts the supports so close together that the plate tips",
                    "move the supports apart");
}

}  // namespace

std::array<Point, 4> corner_supports(const Plate& plate, core::Millimetres inset) {
  const auto right = plate.a - inset;
  const auto top = plate.b - inset;
  return {Point{inset, inset}, Point{right, inset}, Point{inset, top}, Point{right, top}};
}

core::Result<SupportedPlate> SupportedPlate::create(std::unique_ptr<const Discretisation> discretisation, const Plate& plate,
                                                    const Support& support) {
  SupportedPlate result;
  result.discretisation_ = std::move(discretisation);
  result.support_ = support;
  result.hold(plate);
  auto factor = std::make_shared<Eigen::SimplicialLDLT<Matrix>>(result.stiffness_);
  if (factor->info() != Eigen::Success || !(factor->vectorD().minCoeff() > 0.0)) return plate_tips(support);
  result.factor_ = std::move(factor);
  // A load on a corner tips the plate in both directions if it can tip.
  const double limit_m = kLargestCompliance * (plate.a.value * plate.b.value) / kSquareMillimetresPerSquareMetre / plate.rigidity_nm();
  const auto tipping = result.bend(result.vector(result.discretisation_->force({})));
  if (!(tipping.cwiseAbs().maxCoeff() <= limit_m)) return plate_tips(support);
  return result;
}

void SupportedPlate::hold(const Plate& plate) {
  const Grid& grid = discretisation_->grid();
  const int size = discretisation_->dof_count();
  const double scale = plate.rigidity_nm() / (grid.dx_m * grid.dy_m);
  free_stiffness_ = assemble(size, discretisation_->stiffness());

  is_held_.assign(static_cast<std::size_t>(size), false);
  const int per_node = discretisation_->dofs_per_node();
  for (int j = 0; j <= grid.divisions; ++j) {
    for (int i = 0; i <= grid.divisions; ++i) {
      const auto held = discretisation_->held_dofs(support_.kind, i, j);
      std::copy_n(held.begin(), per_node, is_held_.begin() + per_node * grid.node(i, j));
    }
  }
  if (support_.kind == SupportKind::Corner) {
    for (const Point& point : corner_supports(plate, support_.inset)) point_supports_.push_back(discretisation_->force({.centre = point}));
  }
  std::vector<StiffnessEntry> holding;
  for (const Weights& support : point_supports_) {
    for (const auto& [row, a] : support) {
      for (const auto& [column, b] : support) holding.push_back({row, column, kSupportStiffness * scale * a * b});
    }
  }
  for (int dof = 0; dof < size; ++dof) {
    if (is_held(dof)) holding.push_back({dof, dof, scale});
  }
  stiffness_ = free_stiffness_;
  if (support_.kind != SupportKind::Corner)
    stiffness_.prune([&](auto row, auto column, double) { return !is_held(row) && !is_held(column); });
  stiffness_ += assemble(size, holding);
}

Eigen::VectorXd SupportedPlate::bend(const Eigen::VectorXd& force_n) const { return factor_->solve(force_n); }

Eigen::VectorXd SupportedPlate::whole(const Weights& weights) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(discretisation_->dof_count());
  for (const auto& [dof, value] : weights) result[dof] += value;
  return result;
}

Eigen::VectorXd SupportedPlate::vector(const Weights& weights) const {
  Eigen::VectorXd result = whole(weights);
  for (int dof = 0; dof < discretisation_->dof_count(); ++dof) {
    if (is_held(dof)) result[dof] = 0.0;
  }
  return result;
}

double SupportedPlate::read(const Eigen::VectorXd& dofs, const Weights& weights) {
  double sum = 0.0;
  for (const auto& [dof, value] : weights) sum += value * dofs[dof];
  return sum;
}

std::vector<double> SupportedPlate::reactions_n(const Eigen::VectorXd& unbalanced_n) const {
  if (support_.kind == SupportKind::Corner) {  // unbalanced = sum of the supports' weights times their reactions
    Eigen::Matrix4d overlap;
    Eigen::Vector4d share;
    for (int a = 0; a < 4; ++a) {
      const auto dense = vector(point_supports_[static_cast<std::size_t>(a)]);
      share[a] = dense.dot(unbalanced_n);
      for (int b = 0; b < 4; ++b) overlap(a, b) = read(dense, point_supports_[static_cast<std::size_t>(b)]);
    }
    const Eigen::Vector4d reactions = overlap.ldlt().solve(share);
    return {reactions.begin(), reactions.end()};
  }
  const Grid& grid = discretisation_->grid();
  std::array<double, 4> edges{};  // x = 0, x = a, y = 0, y = b
  for (int j = 0; j <= grid.divisions; ++j) {
    for (int i = 0; i <= grid.divisions; ++i) {
      const bool is_on_x = grid.is_on_x_edge(i);
      const bool is_on_y = grid.is_on_y_edge(j) && support_.kind != SupportKind::XEdges;
      const double force = unbalanced_n[discretisation_->dofs_per_node() * grid.node(i, j)] / (is_on_x && is_on_y ? 2.0 : 1.0);
      if (is_on_x) edges[i == 0 ? 0 : 1] += force;
      if (is_on_y) edges[j == 0 ? 2 : 3] += force;
    }
  }
  return {edges.begin(), support_.kind == SupportKind::XEdges ? edges.begin() + 2 : edges.end()};
}

}  // namespace dts::physics
