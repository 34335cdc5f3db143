// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace dts::device::sim {

/// How a careful assistant works: puts a thing down, waits, takes it away, rests, takes the next one. Seconds of the device.
struct PlacementTimes {
  double first_s = 2.5;  ///< The first thing begins to touch.
  double ramp_s = 0.5;   ///< Putting down, and taking away again.
  double hold_s = 3.0;   ///< All of it rests.
  double pause_s = 1.0;  ///< Nothing is there.
  bool repeats = false;  ///< After the last thing again the first one.
};

/// What is there at one moment.
struct Placement {
  std::size_t index = 0;  ///< Which thing.
  double part = 0.0;      ///< 0 nothing of it .. 1 all of it.
};

///     part 1       ______            ______
///                 /      \          /      \            smooth at both ends
///          0 ____/        \________/        \_____
///         first^ ramp hold ramp pause ...
///
/// `count` things, at least one, one after the other. Thread: any. Realtime-safe: yes.
[[nodiscard]] Placement placement_at(const PlacementTimes& times, std::size_t count, double time_s) noexcept;

}  // namespace dts::device::sim
