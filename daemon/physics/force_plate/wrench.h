// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace dts::physics {

/// A force and its moment about one point. A plate measures what the person does to it (the action) or what it does to the person (the
/// reaction); a Wrench has no sign convention of its own.
struct Wrench {
  std::array<double, 3> force_n{};
  std::array<double, 3> moment_nm{};
};

/// Returns the wrench about another point, which is `offset_mm` away from the old one: M' = M + F x offset.
[[nodiscard]] Wrench about(const Wrench& wrench, const std::array<double, 3>& offset_mm) noexcept;

/// Where the force meets the surface, and the free moment there.
struct ForcePoint {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double free_moment_nm = 0.0;
};

/// Returns the point in the plane through the point of `wrench` at which the moment has only a vertical part: x = -My/Fz, y = Mx/Fz,
/// Tz = Mz - (x Fy - y Fx) (Kistler, Force Plate Formulae, 1999). It is the same for action and reaction. If Fz is 0, it is not finite.
[[nodiscard]] ForcePoint force_point(const Wrench& wrench) noexcept;

/// The polynomial by which Kistler corrects the bending of a top plate. Both results come from the uncorrected point, in mm (9287C manual,
/// 8.4.3): corrected x = x - ((P1 y^4 + P2 y^2 + P3) x^3 + (P4 y^4 + P5 y^2 + P6) x), and the same for y with x and y exchanged.
struct PointPolynomial {
  std::array<double, 6> x{};
  std::array<double, 6> y{};
};

/// Returns the corrected point, with its free moment.
[[nodiscard]] ForcePoint corrected(const Wrench& wrench, const PointPolynomial& polynomial) noexcept;

}  // namespace dts::physics
