// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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
  Corner,  ///< Four point supports at (d,d), (a-d,d), (d,b-d), (a-d,b-d); all edges free.
  Edges,   ///< All four edges simply supported.
};

struct Support {
  SupportKind kind = SupportKind::Corner;
  core::Millimetres inset{0.0};  ///< d; only for Corner.
};

/// Deflection at fixed probes under any load, from one factorisation: by reciprocity the deflection at a probe is the
/// load vector times the probe's influence row (energy finite differences, plate-model section 2).
///
/// Deflections are positive along the load, millimetres per newton. Const methods: Thread: any. Realtime-safe: yes.
class InfluenceTable {
 public:
  static constexpr int kDefaultDivisions = 40;
  static constexpr int kMinDivisions = 4;
  static constexpr int kMaxDivisions = 200;

  /// Solves once per probe. Fails with InvalidArgument when the plate, the support, a probe or `divisions` (4..200)
  /// makes no sense; the message names the value and its range.
  [[nodiscard]] static core::Result<InfluenceTable> create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                           int divisions = kDefaultDivisions);

  [[nodiscard]] std::size_t probe_count() const noexcept { return rows_.size(); }
  /// Deflection at `probe` under 1 N at `load`; positions off the plate count as its nearest edge. NaN when a coordinate is
  /// not finite or there is no such probe.
  [[nodiscard]] double at_point_mm_per_n(std::size_t probe, Point load) const noexcept;
  /// Deflection at `probe` under 1 N spread evenly over `patch` (the part on the plate carries all of it): the exact mean of
  /// the bilinear interpolation of the row. A side of no length is a line or point load. NaN as `at_point_mm_per_n`.
  [[nodiscard]] double under_patch_mm_per_n(std::size_t probe, const Patch& patch) const noexcept;

 private:
  InfluenceTable() = default;

  int divisions_ = kDefaultDivisions;
  double dx_mm_ = 0.0;
  double dy_mm_ = 0.0;
  std::vector<std::vector<double>> rows_;  ///< Per probe, per node, mm/N.
};

}  // namespace dts::physics
