// SPDX-License-Identifier: Apache-2.0
#include "physics/force_plate/wrench.h"

#include "physics/conversions.h"

namespace dts::physics {
namespace {

double free_moment_nm(const Wrench& wrench, double x_mm, double y_mm) noexcept {
  return wrench.moment_nm[2] - (x_mm * wrench.force_n[1] - y_mm * wrench.force_n[0]) / kMillimetresPerMetre;
}

/// Returns the error of the coordinate `along`; `across` is the other one.
double error_mm(const std::array<double, 6>& p, double along, double across) noexcept {
  const double square = across * across;
  return ((p[0] * square + p[1]) * square + p[2]) * along * along * along + ((p[3] * square + p[4]) * square + p[5]) * along;
}

}  // namespace

Wrench about(const Wrench& wrench, const std::array<double, 3>& offset_mm) noexcept {
  const auto& [fx, fy, fz] = wrench.force_n;
  const auto& [ox, oy, oz] = offset_mm;
  Wrench moved = wrench;
  moved.moment_nm[0] += (fy * oz - fz * oy) / kMillimetresPerMetre;
  moved.moment_nm[1] += (fz * ox - fx * oz) / kMillimetresPerMetre;
  moved.moment_nm[2] += (fx * oy - fy * ox) / kMillimetresPerMetre;
  return moved;
}

ForcePoint force_point(const Wrench& wrench) noexcept {
  const double x_mm = -wrench.moment_nm[1] * kMillimetresPerMetre / wrench.force_n[2];
  const double y_mm = wrench.moment_nm[0] * kMillimetresPerMetre / wrench.force_n[2];
  return {.x_mm = x_mm, .y_mm = y_mm, .free_moment_nm = free_moment_nm(wrench, x_mm, y_mm)};
}

ForcePoint corrected(const Wrench& wrench, const PointPolynomial& polynomial) noexcept {
  const ForcePoint measured = force_point(wrench);
  const double x_mm = measured.x_mm - error_mm(polynomial.x, measured.x_mm, measured.y_mm);
  const double y_mm = measured.y_mm - error_mm(polynomial.y, measured.y_mm, measured.x_mm);
  return {.x_mm = x_mm, .y_mm = y_mm, .free_moment_nm = free_moment_nm(wrench, x_mm, y_mm)};
}

}  // namespace dts::physics
