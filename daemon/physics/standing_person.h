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

/// Who stands where and when. Plate-centre origin, ML to the right, AP forward; times in seconds of the device.
struct Stance {
  ContactKind kind = ContactKind::Feet;
  core::Newtons load{686.0};
  core::Millimetres centre_ml{0.0};  ///< Point: where it is. Feet: the middle between the four patches.
  core::Millimetres centre_ap{0.0};
  core::Millimetres width{200.0};                               ///< Between the middle lines of the feet.
  core::Millimetres foot_length{255.0};                         ///< Heel to toe.
  double step_on_s = 2.5;                                       ///< First touch.
  double step_off_s = std::numeric_limits<double>::infinity();  ///< Begins to leave.
  std::uint64_t seed = 1;                                       ///< Phases of breathing and heart beat.
};

/// What presses on the plate at one moment.
struct Contact {
  std::array<double, kMaxContacts> force_n{};  ///< On each patch of `StandingPerson::patches`.
  CopPosition cop;                             ///< Exact centre of these forces, plate-centre origin; NaN without load.
  double load_n = 0.0;                         ///< Their sum.
};

/// How far a person has got onto the plate.
struct StepPhase {
  double loaded = 0.0;    ///< Part of the weight on the plate: 0 nobody .. 1 all of it.
  double two_feet = 0.0;  ///< Weight shift: 0 all on the left foot .. 1 as the person stands.
};

/// A body on the plate: gives every patch the force that puts the common centre of force exactly at the wanted centre of
/// pressure. ML decides the share of left and right, AP the share of heel and forefoot (both feet alike):
///
///     forefoot  [1]     [3]          force = load * (left or right share) * (heel or forefoot share)
///                   x   <- COP
///     heel      [0]     [2]          clamped to the rectangle through the four patch centres
///              left    right
///
/// Stepping on: the left foot takes the weight (0.8 s), then the right foot is put down and takes its share (0.7 s);
/// stepping off is the same backwards. All shapes and times are assumptions, chosen to look like a clinic's recording.
class StandingPerson {
 public:
  static constexpr double kLoadingS = 0.8;
  static constexpr double kShiftS = 0.7;

  /// Fails with InvalidArgument when a patch would lie off the plate, the load is not positive or the person would leave
  /// before having arrived; the message names the value.
  [[nodiscard]] static core::Result<StandingPerson> create(const Stance& stance, const Plate& plate);

  /// Plate coordinates (corner origin): four for feet (left heel, left forefoot, right heel, right forefoot); one of no
  /// size for a point.
  [[nodiscard]] std::span<const Patch> patches() const noexcept { return {patches_.data(), patch_count_}; }

  /// `sway` is the wanted COP from the stance's centre, mm; a point ignores it. Thread: any. Realtime-safe: yes.
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
