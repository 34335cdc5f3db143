// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/result.h"
#include "core/units.h"
#include "physics/plate/plate.h"

namespace dts::physics {

inline constexpr std::size_t kMaxContacts = 4;

enum class ContactKind : std::uint8_t {
  Feet,     ///< Two feet, each a heel and a forefoot patch.
  OneFoot,  ///< One foot: the left and the right half of its heel and of its forefoot, the heel's as far apart as the forefoot's.
  Point,    ///< The whole load at one point: a calibration weight.
};

/// Who stands on the plate, where and when. Origin at the plate's centre, ML to the right, AP forward; times in device seconds.
struct Stance {
  ContactKind kind = ContactKind::Feet;
  core::Newtons load{686.0};
  core::Millimetres centre_ml{0.0};  ///< Point: its position. Feet, OneFoot: the centre of the four patches.
  core::Millimetres centre_ap{0.0};
  core::Millimetres width{200.0};                               ///< Feet only: between their middle lines.
  core::Millimetres foot_length{255.0};                         ///< Heel to toe.
  double step_on_s = 2.5;                                       ///< First touch.
  double step_off_s = std::numeric_limits<double>::infinity();  ///< The moment at which the person begins to step off.
  std::uint64_t seed = 1;                                       ///< Sets the phases of breathing and heart beat.
};

/// Where a stance touches the plate. Plate coordinates (corner origin).
struct StancePatches {
  std::array<Patch, kMaxContacts> patches{};  ///< Left heel, left forefoot, right heel, right forefoot; of a point only the first.
  std::size_t count = 0;
  double width_mm = 0.0;             ///< Feet, OneFoot: between the centres of the left and right patches.
  double heel_to_forefoot_mm = 0.0;  ///< Feet, OneFoot.

  [[nodiscard]] std::span<const Patch> used() const noexcept { return {patches.data(), count}; }
};

/// Fails with InvalidArgument if a patch lies off the plate or the load is not positive; the message names the value.
[[nodiscard]] core::Result<StancePatches> place_stance(const Stance& stance, const Plate& plate);

}  // namespace dts::physics
