// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "files/toml_reader.h"
#include "pipeline/rig_config.h"

namespace dts::files {

/// Reads a rig file (plate, supports, sensors, acquisition, stages; see config/rigs) and the sensor and calibration files it names.
/// Everything wrong is added to `problems`; what is returned is complete only when nothing was. Name, device and thread
/// policies are not in the file: they belong to the daemon's configuration.
[[nodiscard]] pipeline::RigConfig read_rig_file(const std::string& file, Problems& problems);
/// The same of a text that needs no other file, as `rig_definition` makes it; `name` stands for the file in problems.
[[nodiscard]] pipeline::RigConfig read_rig_text(const std::string& text, const std::string& name, Problems& problems);

/// A rig file with all it refers to as one TOML text, so that a recording can be computed again when the files are long gone: curves and
/// calibration become tables where their names stood. Every number reads back as exactly the same double. Above 1 MiB the points of a
/// calibration are left out: they are its evidence, nothing is computed with them. Fails with InvalidArgument and the first problem when
/// the rig file is not in order.
[[nodiscard]] core::Result<std::string> rig_definition(const std::string& file);

}  // namespace dts::files
