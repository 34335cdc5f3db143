// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"
#include "core/units.h"

namespace dts::physics {

/// A position on the plate. Origin at a plate corner, x right (ML), y up (AP), as in the thesis's tables.
struct Point {
  core::Millimetres x;
  core::Millimetres y;

  friend bool operator==(const Point&, const Point&) = default;
};

/// An axis-parallel rectangle under uniform pressure, given by its centre and side lengths.
struct Patch {
  Point centre;
  core::Millimetres width;   ///< Along x.
  core::Millimetres height;  ///< Along y.
};

/// A thin (Kirchhoff) plate. Thesis 3.2 with the corrected flexural rigidity E h^3 / (12 (1 - nu^2)).
struct Plate {
  core::Millimetres a{430.0};  ///< Length along x.
  core::Millimetres b{430.0};  ///< Length along y.
  core::Millimetres h{3.0};    ///< Thickness.
  double e_pa = 198.7e9;       ///< Young's modulus, Pa.
  double nu = 0.27;            ///< Poisson's ratio.

  [[nodiscard]] double rigidity_nm() const noexcept;  ///< D, N m.
};

enum class SupportKind : std::uint8_t {
  Corner,   ///< Four point supports at (d,d), (a-d,d), (d,b-d), (a-d,b-d); all edges free.
  Edges,    ///< All four edges simply supported.
  XEdges,   ///< x = 0 and x = a simply supported, y = 0 and y = b free.
  Clamped,  ///< All four edges held with zero slope.
};

struct Support {
  SupportKind kind = SupportKind::Corner;
  core::Millimetres inset{0.0};  ///< d; only for Corner.
};

/// Fails with InvalidArgument if a value is out of range; the message names the value and the range.
[[nodiscard]] core::Status check_plate(const Plate& plate);
[[nodiscard]] core::Status check_support(const Plate& plate, const Support& support);
/// The message starts with `name`, for example "probe 3".
[[nodiscard]] core::Status check_on_plate(const Plate& plate, Point point, const std::string& name);
[[nodiscard]] core::Status check_divisions(int divisions, int lowest, int highest);

}  // namespace dts::physics
