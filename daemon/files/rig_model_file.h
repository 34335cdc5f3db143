// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "files/toml_reader.h"
#include "physics/rig_model.h"

namespace dts::files {

/// The physical part of a rig file: plate, support and sensors, or a force plate.
struct RigModelFile {
  physics::RigModel model;
  std::vector<std::size_t> sensor_channels;  ///< Device channel of each input of the model (`physics::input_names`).
};

/// Reads [plate], [support] and [[sensor]] of a rig file, or [force_plate] instead, and the sensor files that they name (relative to the
/// rig file) unless the curves are tables. Adds every error to `problems`; the returned model is complete only if there was no error. The
/// caller handles all other keys.
[[nodiscard]] RigModelFile read_rig_model(TomlReader& top, Problems& problems, References references = References::Files);
/// Read only [plate] and [support]: a plate case of the laboratory has the same tables.
[[nodiscard]] physics::Plate read_plate(TomlReader reader);
[[nodiscard]] physics::Support read_support(TomlReader reader, const physics::Plate& plate);

}  // namespace dts::files
