// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace dts::device::sim {

/// Times at which objects (weights or spacers) are placed and removed, one after the other. Seconds of the device's clock.
struct PlacementTimes {
  double first_s = 2.5;  ///< When the first object begins to touch.
  double ramp_s = 0.5;   ///< Duration of placing, and of removing.
  double hold_s = 3.0;   ///< How long an object rests with its full load.
  double pause_s = 1.0;  ///< Time without an object.
  bool repeats = false;  ///< Starts again with the first object after the last.
};

/// The object at one moment.
struct Placement {
  std::size_t index = 0;  ///< Number of the object, from 0.
  double part = 0.0;      ///< Share of the object's load that rests on the plate: 0 .. 1.
};

///     part 1       ______            ______
///                 /      \          /      \            smooth at both ends
///          0 ____/        \________/        \_____
///         first^ ramp hold ramp pause ...
///
/// Returns the object at `time_s` for `count` objects, at least one. Thread: any. Realtime-safe: yes.
[[nodiscard]] Placement placement_at(const PlacementTimes& times, std::size_t count, double time_s) noexcept;

}  // namespace dts::device::sim
