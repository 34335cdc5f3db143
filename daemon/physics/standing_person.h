// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/result.h"
#include "core/units.h"
#include "physics/cop_position.h"
#include "physics/plate/plate.h"

namespace dts::physics {

inline constexpr std::size_t kMaxContacts = 4;

enum class ContactKind : std::uint8_t {
  Feet,   ///< Two feet, each a heel and a forefoot patch.
  Point,  ///< The whole load at one point: a calibration weight.
};

/// Who stands on the plate, where and when. Origin at the plate's centre, ML to the right, AP forward; times in device seconds.
struct Stance {
  ContactKind kind = ContactKind::Feet;
  core::Newtons load{686.0};
  core::Millimetres centre_ml{0.0};  ///< Point: its position. Feet: the centre of the four patches.
  core::Millimetres centre_ap{0.0};
  core::Millimetres width{200.0};                               ///< Between the middle lines of the feet.
  core::Millimetres foot_length{255.0};                         ///< Heel to toe.
  double step_on_s = 2.5;                                       ///< First touch.
  double step_off_s = std::numeric_limits<double>::infinity();  ///< The moment at which the person begins to step off.
  std::uint64_t seed = 1;                                       ///< Sets the phases of breathing and heart beat.
};

/// The forces on the plate at one moment.
struct Contact {
  std::array<double, kMaxContacts> force_n{};  ///< On each patch of `StandingPerson::patches`.
  CopPosition cop;                             ///< Exact centre of these forces, plate-centre origin; NaN without load.
  double load_n = 0.0;                         ///< Sum of `force_n`.
};

/// How far a person has stepped onto the plate.
struct StepPhase {
  double loaded = 0.0;    ///< Fraction of the weight on the plate: 0 none .. 1 all.
  double two_feet = 0.0;  ///< Weight shift: 0 all on the left foot .. 1 the person's normal stance.
};

/// A person on the plate. Computes the force on each patch so that the centre of all forces is exactly the wanted centre of pressure. ML
/// sets the left and right shares, AP the heel and forefoot shares (the same for both feet):
///
///     forefoot  [1]     [3]          force = load * (left or right share) * (heel or forefoot share)
///                   x   <- COP
///     heel      [0]     [2]          clamped to the rectangle through the four patch centres
///              left    right
///
/// Stepping on: the left foot is loaded (0.8 s), then the right foot is put down and loaded (0.7 s). Stepping off is the reverse. All
/// shapes and times are assumptions, chosen to look like a clinical recording.
class StandingPerson {
 public:
  static constexpr double kLoadingS = 0.8;
  static constexpr double kShiftS = 0.7;

  /// Fails with InvalidArgument if a patch lies off the plate, the load is not positive, or the person steps off before stepping on is
  /// complete; the message names the value.
  [[nodiscard]] static core::Result<StandingPerson> create(const Stance& stance, const Plate& plate);

  /// Plate coordinates (corner origin). Feet: four patches (left heel, left forefoot, right heel, right forefoot). Point: one patch of size
  /// 0.
  [[nodiscard]] std::span<const Patch> patches() const noexcept { return {patches_.data(), patch_count_}; }

  /// `sway` is the wanted COP relative to the centre of the stance, mm; ContactKind::Point ignores it. Thread: any. Realtime-safe: yes.
  [[nodiscard]] Contact at(double time_s, CopPosition sway) const noexcept;

  /// Thread: any. Realtime-safe: yes.
  [[nodiscard]] StepPhase phase(double time_s) const noexcept;

 private:
  explicit StandingPerson(const Stance& stance) noexcept : stance_(stance) {}

  void place_feet(const Plate& plate);
  void place_point(const Plate& plate);
  [[nodiscard]] double weight_n(double time_s) const noexcept;

  Stance stance_;
  std::array<Patch, kMaxContacts> patches_{};
  std::size_t patch_count_ = 0;
  double heel_to_forefoot_mm_ = 0.0;
  double breathing_phase_ = 0.0;
  double heart_phase_ = 0.0;
};

}  // namespace dts::physics
