// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/plate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "physics/plate/plate_energy.h"

namespace dts::physics {
namespace {

constexpr double kMillimetresPerMetre = 1000.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Far wider than any rig: they keep typing errors (metres for millimetres, GPa for Pa) and meaningless plates out.
constexpr double kMinSideMm = 10.0;
constexpr double kMaxSideMm = 10'000.0;
constexpr double kMaxSideRatio = 20.0;
constexpr double kMinThicknessMm = 0.01;
constexpr double kMaxThicknessPerSide = 0.2;  ///< Above it, thin-plate theory does not hold.
constexpr double kMinModulusPa = 1e5;
constexpr double kMaxModulusPa = 1e13;

core::Status out_of_range(const std::string& what, double value, const std::string& range) {
  std::ostringstream message;
  message << what << " is " << value << ", outside " << range;
  return core::fail(core::ErrorCode::InvalidArgument, message.str());
}

/// True for NaN too.
bool is_outside(double value, double lowest, double highest) { return !(value >= lowest && value <= highest); }

std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

core::Status check_plate(const Plate& plate) {
  const auto sides = text(kMinSideMm) + ".." + text(kMaxSideMm) + " mm";
  if (is_outside(plate.a.value, kMinSideMm, kMaxSideMm)) return out_of_range("plate length a", plate.a.value, sides);
  if (is_outside(plate.b.value, kMinSideMm, kMaxSideMm)) return out_of_range("plate length b", plate.b.value, sides);
  const double shorter = std::min(plate.a.value, plate.b.value);
  const double ratio = std::max(plate.a.value, plate.b.value) / shorter;
  if (ratio > kMaxSideRatio) return out_of_range("ratio of the plate's sides", ratio, "1.." + text(kMaxSideRatio));
  if (is_outside(plate.h.value, kMinThicknessMm, kMaxThicknessPerSide * shorter)) {
    const auto range = text(kMinThicknessMm) + ".." + text(kMaxThicknessPerSide * shorter) + " mm (a fifth of the shorter side)";
    return out_of_range("plate thickness h", plate.h.value, range);
  }
  if (is_outside(plate.e_pa, kMinModulusPa, kMaxModulusPa)) {
    return out_of_range("Young's modulus", plate.e_pa, text(kMinModulusPa) + ".." + text(kMaxModulusPa) + " Pa");
  }
  if (!(plate.nu > -1.0 && plate.nu < 0.5)) return out_of_range("Poisson's ratio", plate.nu, "-1..0.5 (ends excluded)");
  return {};
}

core::Status check_support(const Plate& plate, const Support& support) {
  if (support.kind == SupportKind::Edges) return {};
  if (support.kind != SupportKind::Corner) {
    return out_of_range("support kind", static_cast<double>(support.kind), "0 (corner) and 1 (edges)");
  }
  const double limit = 0.5 * std::min(plate.a.value, plate.b.value);
  if (support.inset.value >= 0.0 && support.inset.value < limit) return {};
  return out_of_range("support inset", support.inset.value, "0.." + text(limit) + " mm (end excluded)");
}

core::Status check_probes(const Plate& plate, std::span<const Point> probes) {
  if (probes.empty()) return core::fail(core::ErrorCode::InvalidArgument, "there is no probe", "name at least one sensor position");
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const auto name = "probe " + std::to_string(k) + ": ";
    const double x = probes[k].x.value;
    const double y = probes[k].y.value;
    if (is_outside(x, 0.0, plate.a.value)) return out_of_range(name + "x", x, "the plate, 0.." + text(plate.a.value) + " mm");
    if (is_outside(y, 0.0, plate.b.value)) return out_of_range(name + "y", y, "the plate, 0.." + text(plate.b.value) + " mm");
  }
  return {};
}

core::Status check_divisions(int divisions) {
  if (divisions >= InfluenceTable::kMinDivisions && divisions <= InfluenceTable::kMaxDivisions) return {};
  const auto range = std::to_string(InfluenceTable::kMinDivisions) + ".." + std::to_string(InfluenceTable::kMaxDivisions);
  return out_of_range("number of divisions", divisions, range);
}

/// What each grid line of one axis carries of a load spread evenly over a stretch of that axis. The weights sum to 1.
struct LineWeights {
  std::size_t first = 0;
  std::size_t count = 0;
  std::array<double, InfluenceTable::kMaxDivisions + 1> weight;  // only [0, count) is set: clearing it all would cost more than the sum
};

/// Mean of each line's hat function over [from, to], in units of the spacing, 0 <= from <= to <= divisions.
void spread(LineWeights& lines, double from, double to, int divisions) noexcept {
  constexpr double kPointLength = 1e-9;
  const int first_cell = std::min(static_cast<int>(from), divisions - 1);
  const int last_cell = std::min(static_cast<int>(to), divisions - 1);
  lines.first = static_cast<std::size_t>(first_cell);
  lines.count = static_cast<std::size_t>(last_cell - first_cell) + 2;
  const double length = to - from;
  if (length < kPointLength) {
    lines.count = 2;
    lines.weight[1] = from - first_cell;
    lines.weight[0] = 1.0 - lines.weight[1];
    return;
  }
  std::fill_n(lines.weight.begin(), lines.count, 0.0);
  for (int cell = first_cell; cell <= last_cell; ++cell) {
    const double s = std::max(from - cell, 0.0);
    const double t = std::min(to - cell, 1.0);
    const double right = 0.5 * (t * t - s * s) / length;
    const auto k = static_cast<std::size_t>(cell - first_cell);
    lines.weight[k] += (t - s) / length - right;
    lines.weight[k + 1] += right;
  }
}

}  // namespace

double Plate::rigidity_nm() const noexcept {
  // Thesis eq. 3.2 prints 1 - nu; plate theory and the thesis's own FEM columns have 1 - nu^2.
  const double h_m = h.value / kMillimetresPerMetre;
  return e_pa * h_m * h_m * h_m / (12.0 * (1.0 - nu * nu));
}

core::Result<InfluenceTable> InfluenceTable::create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                    int divisions) {
  for (const auto& status : {check_plate(plate), check_support(plate, support), check_probes(plate, probes), check_divisions(divisions)}) {
    if (!status) return tl::make_unexpected(status.error());
  }
  auto rows = energy::deflections_under_unit_loads(plate, support, energy::Grid::over(plate, divisions), probes);
  if (!rows) return tl::make_unexpected(rows.error());
  for (auto& row : *rows) {
    for (double& deflection : row) deflection *= kMillimetresPerMetre;
  }
  InfluenceTable table;
  table.divisions_ = divisions;
  table.dx_mm_ = plate.a.value / divisions;
  table.dy_mm_ = plate.b.value / divisions;
  table.rows_ = std::move(*rows);
  return table;
}

double InfluenceTable::at_point_mm_per_n(std::size_t probe, Point load) const noexcept {
  return under_patch_mm_per_n(probe, {.centre = load, .width = {0.0}, .height = {0.0}});
}

double InfluenceTable::under_patch_mm_per_n(std::size_t probe, const Patch& patch) const noexcept {
  const double half_width = 0.5 * std::max(patch.width.value, 0.0) / dx_mm_;
  const double half_height = 0.5 * std::max(patch.height.value, 0.0) / dy_mm_;
  const double across = patch.centre.x.value / dx_mm_;
  const double along = patch.centre.y.value / dy_mm_;
  if (probe >= rows_.size() || !std::isfinite(half_width + half_height + across + along)) return kNan;
  const double end = divisions_;
  LineWeights columns;
  LineWeights lines;
  spread(columns, std::clamp(across - half_width, 0.0, end), std::clamp(across + half_width, 0.0, end), divisions_);
  spread(lines, std::clamp(along - half_height, 0.0, end), std::clamp(along + half_height, 0.0, end), divisions_);
  const double* row = rows_[probe].data();
  double deflection = 0.0;
  for (std::size_t j = 0; j < lines.count; ++j) {
    const double* nodes = row + (lines.first + j) * static_cast<std::size_t>(divisions_ + 1) + columns.first;
    double line = 0.0;
    for (std::size_t i = 0; i < columns.count; ++i) line += columns.weight[i] * nodes[i];
    deflection += lines.weight[j] * line;
  }
  return deflection;
}

}  // namespace dts::physics
