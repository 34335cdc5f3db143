// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "device/sim/fault.h"
#include "device/sim/placement.h"
#include "device/uri_options.h"
#include "physics/stance.h"
#include "sim/daq.h"

namespace dts::device::sim {

/// The load on the plate, or the targets in front of the sensors.
enum class FloorContact : std::uint8_t {
  Feet,     ///< A person on two feet.
  OneFoot,  ///< A person on one foot.
  Point,    ///< One weight at one point.
  Weights,  ///< Weights of a list, one after the other.
  Gaps,     ///< No load: spacers of known height in front of the sensors.
};

/// The options of a simulated floor platform.
struct FloorOptions {
  std::uint64_t seed = 1;
  FloorContact contact = FloorContact::Feet;
  physics::Stance stance;           ///< For Feet, OneFoot and Point.
  std::string cop_file;             ///< For Feet and OneFoot; empty: synthetic sway.
  std::string weights_file;         ///< For Weights.
  std::vector<double> gaps_mm;      ///< For Gaps.
  PlacementTimes placement;         ///< For Weights and Gaps.
  bool is_repeated = false;         ///< Repeats the recording, weights or gaps endlessly.
  bool is_plate_stiffening = true;  ///< true: von Karman's plate; false: the linear plate.
  dts::sim::DaqParameters daq;
  double clock_error_ppm = 0.0;
  double gain_spread = 0.0;     ///< Sensor gains are uniformly distributed in 1 - spread .. 1 + spread.
  double gap_spread_mm = 0.02;  ///< Unloaded gaps are uniformly distributed in nominal +- this.
  std::size_t sensors = 4;
  std::size_t extra = 0;  ///< Number of auxiliary channels with noise only.
  bool has_truth = true;
  Fault fault;

  [[nodiscard]] std::size_t converted_channels() const noexcept { return sensors + extra; }
};

/// Returns every option of `sim:floor`, with defaults and ranges.
[[nodiscard]] std::span<const UriOption> floor_option_table();

/// Reads the options. Fails with InvalidArgument or LimitExceeded, naming the option, also if options contradict each other.
[[nodiscard]] core::Result<FloorOptions> read_floor_options(const DeviceUri& uri, std::size_t rig_sensors);

}  // namespace dts::device::sim
