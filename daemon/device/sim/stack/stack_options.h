// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/result.h"
#include "device/sim/fault.h"
#include "device/sim/floor_options.h"
#include "device/uri_options.h"
#include "physics/rig_model.h"
#include "sim/daq.h"
#include "sim/plate_response.h"

namespace dts::device::sim {

enum class StackPart : std::uint8_t {
  Floor,  ///< The floor platform on top.
  Plate,  ///< The force plate below it.
};

/// The options of one part of a simulated stack.
struct StackOptions {
  StackPart part = StackPart::Floor;
  std::uint64_t seed = 1;
  physics::Stance stance;          ///< Its times are true times.
  double height_mm = 50.0;         ///< Plate: the top of the floor platform above the surface of the force plate.
  dts::sim::PlateDefects defects;  ///< Plate.
  FloorOptions mounting;           ///< Floor: its sensors, their gains and gaps, and the kind of plate.
  double offset_s = 0.0;           ///< How much later everything appears in the device's data.
  double clock_error_ppm = 0.0;
  dts::sim::DaqParameters daq;
  std::size_t inputs = 0;  ///< Number of the rig's inputs: sensors, or channels of the force plate.
  bool has_truth = true;
  Fault fault;

  /// The inputs, then the sync signal.
  [[nodiscard]] std::size_t converted_channels() const noexcept { return inputs + 1; }
};

/// Returns every option of `sim:stack`, with defaults and ranges.
[[nodiscard]] std::span<const UriOption> stack_option_table();

/// Reads the options. Fails with InvalidArgument, naming the option, also if options contradict each other or the rig is of the other kind.
[[nodiscard]] core::Result<StackOptions> read_stack_options(const DeviceUri& uri, const physics::RigModel& rig);

}  // namespace dts::device::sim
