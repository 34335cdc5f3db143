// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/result.h"
#include "device/sim/fault.h"
#include "device/uri_options.h"
#include "sim/daq.h"
#include "sim/seated_person.h"

namespace dts::device::sim {

inline constexpr std::size_t kEmgChannels = 6;

/// Faults of the sensors of a chair; channels count from 0.
struct SensorFaults {
  std::vector<std::size_t> dead;                               ///< Sensors that deliver 0 V.
  std::vector<std::size_t> saturated;                          ///< Sensors above the converter's range.
  std::optional<std::pair<std::size_t, std::size_t>> swapped;  ///< Two sensors with exchanged cables.
  double from_s = 0.0;                                         ///< When dead and saturated sensors begin to fail.
};

/// The options of a simulated chair.
struct ChairOptions {
  dts::sim::SeatedPersonOptions person;
  std::uint64_t seed = 1;
  dts::sim::DaqParameters daq;
  double clock_error_ppm = 0.0;
  double gain_spread = 0.0;
  double gap_spread_mm = 0.1;
  double drift_percent_per_h = 0.0;
  std::size_t sensors = 16;
  bool has_emg = false;
  bool has_truth = true;
  SensorFaults sensor_faults;
  Fault fault;

  [[nodiscard]] std::size_t converted_channels() const noexcept { return sensors + (has_emg ? kEmgChannels : 0); }
};

/// Returns every option of `sim:chair`, with defaults and ranges.
[[nodiscard]] std::span<const UriOption> chair_option_table();

/// Reads the options. Fails with InvalidArgument or LimitExceeded, naming the option, also if options contradict each other.
[[nodiscard]] core::Result<ChairOptions> read_chair_options(const DeviceUri& uri, std::size_t rig_sensors);

}  // namespace dts::device::sim
