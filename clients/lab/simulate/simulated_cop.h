// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"

namespace dts::lab::simulate {

/// A centre of pressure by scan of the device, mm from the plate's centre; NaN where there is none.
struct SimulatedCop {
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;
};

/// Runs a simulated device through the stages of a rig, as fast as possible, and returns the stream "cop" of its first `duration_s`. Each
/// value is at the scan to which it belongs: the delay of the rig's filters is removed. `definition` is the rig as text, `name` stands for
/// it in errors. Fails as device and pipeline, and with InvalidArgument if the rig makes no such stream.
[[nodiscard]] core::Result<SimulatedCop> simulate_cop(const std::string& definition, const std::string& name, const std::string& device_uri,
                                                      double duration_s);

}  // namespace dts::lab::simulate
