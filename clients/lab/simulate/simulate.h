// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/result.h"
#include "pipeline/rig_config.h"

namespace dts::lab::simulate {

/// What to simulate, and where to write it.
struct Simulation {
  pipeline::RigConfig config;  ///< Its `rate` is the rate of the simulated device.
  std::string definition;      ///< Definition of the same rig, as text.
  double duration_s = 0.0;
  std::uint64_t seed = 1;
  std::string out;    ///< New recording.
  std::string truth;  ///< New CSV file of the true values: the centre of pressure, or the reaches; empty: none.
};

struct Simulated {
  std::string file;
  std::string sha256;
  std::uint64_t scans = 0;
  std::uint64_t bytes = 0;
};

/// Records the simulated rig of that kind (`sim:floor?seed=N`, `sim:chair?seed=N`) through the rig's stages into a file, as fast as
/// possible. The same simulation writes the same file except for its dates. Fails as device, pipeline and recorder; never overwrites an
/// existing file.
[[nodiscard]] core::Result<Simulated> simulate_rig(Simulation simulation, const std::function<void(double)>& progress);

}  // namespace dts::lab::simulate
