// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "device/sim/daq.h"
#include "device/sim/fault.h"
#include "device/sim/placement.h"
#include "device/uri_options.h"
#include "physics/standing_person.h"

namespace dts::device::sim {

/// What touches the plate, or the sensors.
enum class FloorContact : std::uint8_t {
  Feet,     ///< A person on two feet.
  Point,    ///< One weight at one point.
  Weights,  ///< Weights of a list, one after the other.
  Gaps,     ///< No plate: spacers of known height in front of the sensors.
};

/// What the URI of a simulated floor platform asks for.
struct FloorOptions {
  std::uint64_t seed = 1;
  FloorContact contact = FloorContact::Feet;
  physics::Stance stance;           ///< Feet and Point.
  std::string cop_file;             ///< Feet; empty: synthetic sway.
  std::string weights_file;         ///< Weights.
  std::vector<double> gaps_mm;      ///< Gaps.
  PlacementTimes placement;         ///< Weights and Gaps.
  bool is_repeated = false;         ///< Recording, weights or gaps go on for ever.
  bool is_plate_stiffening = true;  ///< Von Karman's plate; false: the linear one.
  DaqParameters daq;
  double clock_error_ppm = 0.0;
  double gain_spread = 0.0;     ///< Sensor gains lie evenly in 1 - spread .. 1 + spread.
  double gap_spread_mm = 0.02;  ///< Unloaded gaps lie evenly within +- this of the nominal one.
  std::size_t sensors = 4;
  std::size_t extra = 0;  ///< Auxiliary channels that carry nothing but noise.
  bool has_truth = true;
  Fault fault;

  [[nodiscard]] std::size_t converted_channels() const noexcept { return sensors + extra; }
};

/// Every option of `sim:floor`, with defaults and ranges.
[[nodiscard]] std::span<const UriOption> floor_option_table();

/// Fails with InvalidArgument or LimitExceeded naming the option; also for options that contradict each other.
[[nodiscard]] core::Result<FloorOptions> read_floor_options(const DeviceUri& uri, std::size_t rig_sensors);

}  // namespace dts::device::sim
