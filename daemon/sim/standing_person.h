// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "core/result.h"
#include "physics/plate/plate.h"
#include "physics/stance.h"
#include "sim/cop_position.h"

namespace dts::sim {

/// The forces on the plate at one moment.
struct Contact {
  std::array<double, physics::kMaxContacts> force_n{};  ///< On each patch of `StandingPerson::patches`.
  CopPosition cop;                                      ///< Exact centre of these forces, plate-centre origin; NaN without load.
  double load_n = 0.0;                                  ///< Sum of `force_n`.
};

/// How far a person has stepped onto the plate.
struct StepPhase {
  double loaded = 0.0;    ///< Fraction of the weight on the plate: 0 none .. 1 all.
  double two_feet = 0.0;  ///< Weight shift: 0 all on the left foot (or at the centre of the one foot) .. 1 the person's normal stance.
};

/// A person on the plate. Computes the force on each patch so that the centre of all forces is exactly the wanted centre of pressure. ML
/// sets the left and right shares, AP the heel and forefoot shares (the same for both feet):
///
///     forefoot  [1]     [3]          force = load * (left or right share) * (heel or forefoot share)
///                   x   <- COP
///     heel      [0]     [2]          clamped to the rectangle through the four patch centres
///              left    right
///
/// Stepping on: the left foot is loaded (0.8 s), then the right foot is put down and loaded (0.7 s). Stepping off is the reverse. On one
/// foot, left and right are the halves of its sole; after it is loaded, the sway begins (0.7 s). All shapes and times are assumptions,
/// chosen to look like a clinical recording.
class StandingPerson {
 public:
  static constexpr double kLoadingS = 0.8;
  static constexpr double kShiftS = 0.7;

  /// Fails with InvalidArgument if a patch lies off the plate, the load is not positive, or the person steps off before stepping on is
  /// complete; the message names the value.
  [[nodiscard]] static core::Result<StandingPerson> create(const physics::Stance& stance, const physics::Plate& plate);

  /// Plate coordinates (corner origin). Feet and OneFoot: four patches (left heel, left forefoot, right heel, right forefoot). Point: one
  /// patch of size 0.
  [[nodiscard]] std::span<const physics::Patch> patches() const noexcept { return patches_.used(); }

  /// `sway` is the wanted COP relative to the centre of the stance, mm; ContactKind::Point ignores it. Thread: any. Realtime-safe: yes.
  [[nodiscard]] Contact at(double time_s, CopPosition sway) const noexcept;

  /// Thread: any. Realtime-safe: yes.
  [[nodiscard]] StepPhase phase(double time_s) const noexcept;

 private:
  StandingPerson(const physics::Stance& stance, const physics::StancePatches& patches);

  [[nodiscard]] double weight_n(double time_s) const noexcept;

  physics::Stance stance_;
  physics::StancePatches patches_;
  double breathing_phase_ = 0.0;
  double heart_phase_ = 0.0;
};

}  // namespace dts::sim
