// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "physics/force_plate/force_plate.h"

namespace dts::physics {

/// The way back through a force plate, for simulations: from the reaction on the person to the channels. A plate with more channels than
/// components, such as a Kistler plate, gets the smallest channels that mean this wrench. Immutable; const methods are realtime-safe.
class PlateInverse {
 public:
  PlateInverse(const ForcePlate& plate, const Mounting& mounting);

  /// Writes what the plate's channels are above their tare under `reaction`, which is in the subject's frame and about the centre of the
  /// surface (load cells: about the plane of their contacts, and without shear and Mz). `channels` has `channel_count()` values of the
  /// plate.
  void write_channels(const Wrench& reaction, std::span<double> channels) const noexcept;

 private:
  std::vector<std::array<double, kSixComponents>> rows_;  ///< By channel: of Fx Fy Fz (per N), Mx My Mz (per N m).
};

}  // namespace dts::physics
