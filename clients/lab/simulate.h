// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/result.h"
#include "pipeline/rig_config.h"

namespace dts::lab {

/// What is simulated, and where to.
struct Simulation {
  pipeline::RigConfig config;  ///< Its `rate` is what the simulated device runs at.
  std::string definition;      ///< Of the same rig, as text.
  double duration_s = 0.0;
  std::uint64_t seed = 1;
  std::string out;    ///< New recording.
  std::string truth;  ///< New CSV file of what was true: the centre of pressure, or the reaches; empty: none.
};

struct Simulated {
  std::string file;
  std::string sha256;
  std::uint64_t scans = 0;
  std::uint64_t bytes = 0;
};

/// Records the simulated rig of that kind (`sim:floor?seed=N`, `sim:chair?seed=N`) through the rig's stages into a file, as fast as it can
/// be computed. The same simulation gives the same file but for its dates. Fails as device, pipeline and recorder do; what exists is never
/// overwritten.
[[nodiscard]] core::Result<Simulated> simulate_rig(Simulation simulation, const std::function<void(double)>& progress);

}  // namespace dts::lab
