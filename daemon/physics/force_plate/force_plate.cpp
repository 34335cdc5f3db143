// SPDX-License-Identifier: Apache-2.0
#include "physics/force_plate/force_plate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "physics/conversions.h"

namespace dts::physics {
namespace {

using core::ErrorCode;

constexpr double kSingular = 1e-9;
/// Cells whose triangle is flatter than this part of its longest side squared are in a line.
constexpr double kFlattest = 0.01;

core::Status check_number(std::string_view name, double value, double minimum, double maximum) {
  if (value >= minimum && value <= maximum) return {};
  return core::fail(ErrorCode::InvalidArgument, "force plate: " + std::string(name) + " = " + std::to_string(value) + " is not between " +
                                                    std::to_string(minimum) + " and " + std::to_string(maximum));
}

core::Status check_scale(std::string_view name, std::size_t channel, double newtons_per_unit) {
  if (std::isfinite(newtons_per_unit) && newtons_per_unit != 0.0) return {};
  return core::fail(ErrorCode::InvalidArgument,
                    "force plate: the scale of " + std::string(name) + " " + std::to_string(channel + 1) + " is 0 or not a number");
}

/// Returns twice the area of the triangle, divided by the square of its longest side.
double flatness(const LoadCellPlate::Cell& a, const LoadCellPlate::Cell& b, const LoadCellPlate::Cell& c) {
  const auto square = [](const LoadCellPlate::Cell& p, const LoadCellPlate::Cell& q) {
    return (p.x_mm - q.x_mm) * (p.x_mm - q.x_mm) + (p.y_mm - q.y_mm) * (p.y_mm - q.y_mm);
  };
  const double longest = std::max({square(a, b), square(b, c), square(c, a)});
  return std::abs((b.x_mm - a.x_mm) * (c.y_mm - a.y_mm) - (c.x_mm - a.x_mm) * (b.y_mm - a.y_mm)) / longest;  // NaN if all are the same
}

/// Returns whether some three cells span a triangle.
bool span_a_plane(const std::vector<LoadCellPlate::Cell>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        if (flatness(cells[i], cells[j], cells[k]) > kFlattest) return true;
      }
    }
  }
  return false;
}

constexpr std::size_t axis_index(PlateAxis axis) { return axis == PlateAxis::PlusX || axis == PlateAxis::MinusX ? 0 : 1; }
constexpr double direction(PlateAxis axis) { return axis == PlateAxis::PlusX || axis == PlateAxis::PlusY ? 1.0 : -1.0; }

/// Returns the direction of the subject's "up" along the plate's z: ML x AP.
constexpr double up_along_z(const Mounting& mounting) {
  const double product = direction(mounting.ml) * direction(mounting.ap);
  return axis_index(mounting.ml) == 0 ? product : -product;
}

}  // namespace

core::Result<ForcePlate> ForcePlate::create(const KistlerPlate& plate) {
  DTS_TRY(check_number("a_mm", plate.a_mm, 1.0, 5000.0));
  DTS_TRY(check_number("b_mm", plate.b_mm, 1.0, 5000.0));
  DTS_TRY(check_number("az0_mm", plate.az0_mm, -1000.0, 0.0));
  const double a = plate.a_mm / kMillimetresPerMetre;
  const double b = plate.b_mm / kMillimetresPerMetre;
  // What 1 N in a channel is about the sensors' plane: fx12 fx34 fy14 fy23 fz1 fz2 fz3 fz4.
  const std::array<Wrench, kKistlerChannels> unit{{{.force_n = {1, 0, 0}, .moment_nm = {0, 0, -b}},
                                                   {.force_n = {1, 0, 0}, .moment_nm = {0, 0, b}},
                                                   {.force_n = {0, 1, 0}, .moment_nm = {0, 0, a}},
                                                   {.force_n = {0, 1, 0}, .moment_nm = {0, 0, -a}},
                                                   {.force_n = {0, 0, 1}, .moment_nm = {b, -a, 0}},
                                                   {.force_n = {0, 0, 1}, .moment_nm = {b, a, 0}},
                                                   {.force_n = {0, 0, 1}, .moment_nm = {-b, a, 0}},
                                                   {.force_n = {0, 0, 1}, .moment_nm = {-b, -a, 0}}}};
  std::vector<Column> columns;
  for (std::size_t channel = 0; channel < unit.size(); ++channel) {
    const double scale = plate.newtons_per_unit.at(channel);
    DTS_TRY(check_scale("channel", channel, scale));
    const auto [f, m] = about(unit.at(channel), {0.0, 0.0, plate.az0_mm});
    columns.push_back({scale * f[0], scale * f[1], scale * f[2], scale * m[0], scale * m[1], scale * m[2]});
  }
  return ForcePlate(std::move(columns), true);
}

core::Result<ForcePlate> ForcePlate::create(const SixComponentPlate& plate) {
  for (const double offset_mm : plate.surface_mm) DTS_TRY(check_number("surface_mm", offset_mm, -5000.0, 5000.0));
  std::vector<Column> columns;
  for (std::size_t channel = 0; channel < kSixComponents; ++channel) {
    Wrench unit;
    for (std::size_t row = 0; row < 3; ++row) {
      unit.force_n.at(row) = plate.matrix.at(row).at(channel);
      unit.moment_nm.at(row) = plate.matrix.at(row + 3).at(channel);
    }
    const auto [f, m] = about(unit, plate.surface_mm);
    const Column column{f[0], f[1], f[2], m[0], m[1], m[2]};
    if (!std::ranges::all_of(column, [](double value) { return std::isfinite(value); })) {
      return core::fail(ErrorCode::InvalidArgument, "force plate: the matrix holds a value that is not a number");
    }
    columns.push_back(column);
  }
  return ForcePlate(std::move(columns), true);
}

core::Result<ForcePlate> ForcePlate::create(const LoadCellPlate& plate) {
  if (plate.cells.size() < kFewestLoadCells || plate.cells.size() > kMostLoadCells) {
    return core::fail(ErrorCode::InvalidArgument,
                      "force plate: a plate has 3 or 4 load cells, this one " + std::to_string(plate.cells.size()));
  }
  std::vector<Column> columns;
  for (const LoadCellPlate::Cell& cell : plate.cells) {
    DTS_TRY(check_number("position_mm", cell.x_mm, -5000.0, 5000.0));
    DTS_TRY(check_number("position_mm", cell.y_mm, -5000.0, 5000.0));
    DTS_TRY(check_scale("load cell", columns.size(), cell.newtons_per_unit));
    const double scale = cell.newtons_per_unit;
    columns.push_back({0.0, 0.0, scale, scale * cell.y_mm / kMillimetresPerMetre, -scale * cell.x_mm / kMillimetresPerMetre, 0.0});
  }
  if (!span_a_plane(plate.cells)) {
    return core::fail(ErrorCode::InvalidArgument, "force plate: the load cells are in a line", "place them at the corners of the plate");
  }
  return ForcePlate(std::move(columns), false);
}

Wrench ForcePlate::wrench(std::span<const double> channels) const noexcept {
  Column sum{};
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    for (std::size_t row = 0; row < kSixComponents; ++row) {
      if (columns_[channel][row] != 0.0) sum[row] += columns_[channel][row] * channels[channel];  // NaN spreads no further than its channel
    }
  }
  return {.force_n = {sum[0], sum[1], sum[2]}, .moment_nm = {sum[3], sum[4], sum[5]}};
}

core::Result<SixBySix> calibration_from_sensitivity(const SixBySix& sensitivity) {
  using Matrix = Eigen::Matrix<double, static_cast<int>(kSixComponents), static_cast<int>(kSixComponents)>;
  Matrix matrix;
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      matrix(row, column) = sensitivity.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column));
    }
  }
  if (!matrix.allFinite())
    return core::fail(ErrorCode::InvalidArgument, "force plate: the sensitivity matrix holds a value that is not a number");
  // Newtons and newton metres differ by orders of magnitude: without scaling, a good matrix could look singular.
  const Eigen::Matrix<double, 6, 1> rows = matrix.rowwise().norm();
  const Matrix scaled = rows.cwiseInverse().asDiagonal() * matrix;
  const Eigen::Matrix<double, 6, 1> values = scaled.jacobiSvd().singularValues();
  if (!(rows.minCoeff() > 0.0) || !(values.minCoeff() > kSingular * values.maxCoeff())) {
    return core::fail(ErrorCode::InvalidArgument, "force plate: the sensitivity matrix is singular",
                      "copy all 36 values of the maker's sheet");
  }
  const Matrix inverse = matrix.inverse();
  SixBySix calibration{};
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      calibration.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column)) = inverse(row, column);
    }
  }
  return calibration;
}

core::Status check(const Mounting& mounting) {
  if (axis_index(mounting.ml) == axis_index(mounting.ap)) {
    return core::fail(ErrorCode::InvalidArgument, "force plate: ML and AP are along the same axis of the plate",
                      "name one along x and one along y");
  }
  const bool is_up_along_minus_z = up_along_z(mounting) < 0.0;
  if (is_up_along_minus_z == mounting.is_z_down) return {};
  return core::fail(ErrorCode::InvalidArgument,
                    std::string("force plate: with these axes, z would point ") + (mounting.is_z_down ? "up" : "down") +
                        ", but the plate's axes are \"" + (mounting.is_z_down ? "z_down" : "z_up") + "\"",
                    "the axes are right-handed: turn the sign of ML or of AP");
}

Wrench in_subject_frame(const Wrench& of_plate, const Mounting& mounting) noexcept {
  const double sign = mounting.is_z_down ? -1.0 : 1.0;  // from the action to the reaction
  const double ml = sign * direction(mounting.ml);
  const double ap = sign * direction(mounting.ap);
  const double up = sign * up_along_z(mounting);
  const auto turn = [&](const std::array<double, 3>& v) -> std::array<double, 3> {
    return {ml * v[axis_index(mounting.ml)], ap * v[axis_index(mounting.ap)], up * v[2]};
  };
  return {.force_n = turn(of_plate.force_n), .moment_nm = turn(of_plate.moment_nm)};
}

PointPolynomial in_subject_frame(const PointPolynomial& of_plate, const Mounting& mounting) noexcept {
  if (axis_index(mounting.ml) == 0) return of_plate;
  return {.x = of_plate.y, .y = of_plate.x};
}

}  // namespace dts::physics
