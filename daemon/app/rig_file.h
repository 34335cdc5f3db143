// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "files/toml_reader.h"
#include "session/rig_config.h"

namespace dts::app {

/// Reads a rig file (plate, supports, sensors, acquisition, stages; see config/rigs) and the sensor and calibration files it names.
/// Everything wrong is added to `problems`; what is returned is complete only when nothing was. Name, device and thread
/// policies are not in the file: they belong to the daemon's configuration.
[[nodiscard]] session::RigConfig read_rig_file(const std::string& file, files::Problems& problems);

}  // namespace dts::app
