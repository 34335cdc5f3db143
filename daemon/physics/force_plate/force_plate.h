// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/result.h"
#include "physics/force_plate/wrench.h"

namespace dts::physics {

inline constexpr std::size_t kKistlerChannels = 8;
inline constexpr std::size_t kSixComponents = 6;
inline constexpr std::size_t kFewestLoadCells = 3;
inline constexpr std::size_t kMostLoadCells = 4;

using SixBySix = std::array<std::array<double, kSixComponents>, kSixComponents>;

/// A piezoelectric plate with four three-component sensors at (+a, +b), (-a, +b), (-a, -b), (+a, -b), in the channels
/// fx12 fx34 fy14 fy23 fz1 fz2 fz3 fz4 (Kistler, Force Plate Formulae, 1999).
struct KistlerPlate {
  std::array<double, kKistlerChannels> newtons_per_unit{};  ///< Not 0. Unit: what the channels are in, for example V.
  double a_mm = 0.0;                                        ///< > 0.
  double b_mm = 0.0;                                        ///< > 0.
  double az0_mm = 0.0;                                      ///< z of the surface seen from the sensors; z points down, so it is negative.
};

/// A plate whose transducer gives six channels, with cross-talk: load = matrix x channels (AMTI, Bertec).
struct SixComponentPlate {
  SixBySix matrix{};                   ///< Rows Fx Fy Fz in N, Mx My Mz in N m, per unit of a channel.
  std::array<double, 3> surface_mm{};  ///< Centre of the surface seen from the transducer's origin, in its axes.
};

/// Three or four cells that measure vertical force only: a balance board or a home-made plate.
struct LoadCellPlate {
  struct Cell {
    double x_mm = 0.0;
    double y_mm = 0.0;
    double newtons_per_unit = 0.0;  ///< Not 0.
  };
  std::vector<Cell> cells;
};

/// A force plate: every kind is one matrix from channels to the wrench about the centre of the plate's top surface (load cells: of the
/// plane of their contacts), in the axes and with the sign of the plate's own channels. Immutable; const methods are realtime-safe.
class ForcePlate {
 public:
  /// Fail with InvalidArgument if a number is not finite or outside its range, or if the cells are in a line; the message names the value.
  [[nodiscard]] static core::Result<ForcePlate> create(const KistlerPlate& plate);
  [[nodiscard]] static core::Result<ForcePlate> create(const SixComponentPlate& plate);
  [[nodiscard]] static core::Result<ForcePlate> create(const LoadCellPlate& plate);

  [[nodiscard]] std::size_t channel_count() const noexcept { return columns_.size(); }
  /// Returns false for load cells: they measure Fz, Mx and My only. The other components of their wrenches are 0 and mean nothing.
  [[nodiscard]] bool measures_shear() const noexcept { return measures_shear_; }
  /// `channels` has `channel_count()` values. A NaN makes only the components undefined to which its channel contributes. Realtime-safe:
  /// yes.
  [[nodiscard]] Wrench wrench(std::span<const double> channels) const noexcept;

 private:
  using Column = std::array<double, kSixComponents>;  ///< Fx Fy Fz (N), Mx My Mz (N m) that one unit of a channel adds.
  explicit ForcePlate(std::vector<Column> columns, bool measures_shear) : columns_(std::move(columns)), measures_shear_(measures_shear) {}

  std::vector<Column> columns_;
  bool measures_shear_;
};

/// Returns the inverse of a sensitivity matrix, for example in uV/(V N) and uV/(V N m). Fails with InvalidArgument if it is singular or
/// nearly so (smallest by largest singular value, rows scaled to length 1, below 1e-9).
[[nodiscard]] core::Result<SixBySix> calibration_from_sensitivity(const SixBySix& sensitivity);

/// One axis of a plate: +x, -x, +y or -y.
enum class PlateAxis : std::uint8_t { PlusX, MinusX, PlusY, MinusY };

/// How a plate lies under the subject.
struct Mounting {
  PlateAxis ml = PlateAxis::PlusX;   ///< Points to the subject's right.
  PlateAxis ap = PlateAxis::MinusY;  ///< Points forward.
  bool is_z_down = true;  ///< The channels are the action with z down (Fz > 0 under load); false: the reaction with z up (also Fz > 0).
};

/// Fails with InvalidArgument if the axes are not perpendicular, or if they would need the other direction of z (all axes are
/// right-handed); the message says which.
[[nodiscard]] core::Status check(const Mounting& mounting);

/// Returns the reaction on the person in the subject's frame: x to the right, y forward, z up.
[[nodiscard]] Wrench in_subject_frame(const Wrench& of_plate, const Mounting& mounting) noexcept;
/// Returns the same correction for a point in the subject's frame. Only an exchange of the axes matters: the polynomials are odd in their
/// own coordinate and even in the other one.
[[nodiscard]] PointPolynomial in_subject_frame(const PointPolynomial& of_plate, const Mounting& mounting) noexcept;

}  // namespace dts::physics
