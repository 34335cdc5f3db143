// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/force_plate/plate_inverse.h"
#include "physics/rig_model.h"
#include "sim/stack_person.h"

namespace dts::sim {

/// What a real force plate adds to its calibration.
struct PlateDefects {
  double cross_talk = 0.0;     ///< Largest part of the vertical force that appears as shear, and of the shear as vertical force.
  double drift_n_per_s = 0.0;  ///< How fast the zero of the vertical force creeps.
  std::uint64_t seed = 1;      ///< Sets the signs and sizes of both.
};

/// The channels of a force plate under a person who stands on something of a given height, such as a DTS platform:
///
///     person's force at the COP, `height_mm` above the surface -> wrench about the surface -> cross-talk, drift -> PlateInverse -> volts
///
/// The drift is that of charge amplifiers: it is proportional to time, as if a force that grows acted at one point near the centre, with
/// up to a quarter of it along each axis as shear. Noise and codes come from `Daq`. Immutable; const methods: Thread: any. Realtime-safe:
/// yes.
class PlateResponse {
 public:
  PlateResponse(const physics::ForcePlateModel& plate, double height_mm, const PlateDefects& defects);

  /// Writes the volts of every channel, with the tare of the rig's model. `since_reset_s` is the time since the amplifier's reset.
  void write_volts(const StandingMoment& moment, double since_reset_s, std::span<double> volts) const noexcept;

 private:
  [[nodiscard]] physics::Wrench about_surface(const StandingMoment& moment) const noexcept;
  [[nodiscard]] physics::Wrench with_defects(const physics::Wrench& wrench, double since_reset_s) const noexcept;

  physics::PlateInverse inverse_;
  std::vector<double> tare_v_;
  double height_mm_;
  double shear_of_vertical_ml_;  ///< Cross-talk: N of shear per N of vertical force.
  double shear_of_vertical_ap_;
  double vertical_of_ml_;
  double vertical_of_ap_;
  physics::Wrench drift_per_s_;
};

}  // namespace dts::sim
