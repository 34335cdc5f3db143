// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "files/toml_reader.h"
#include "physics/cop/cop_calibration.h"
#include "physics/rig_model.h"
#include "pipeline/rig_config.h"

namespace dts::files {

/// Reads a rig file (plate, supports, sensors, acquisition, stages; see config/rigs) and the sensor and calibration files that it names.
/// Adds every error to `problems`; the returned configuration is complete only if there was no error. Does not set name, device and thread
/// policies: they are in the daemon's configuration.
[[nodiscard]] pipeline::RigConfig read_rig_file(const std::string& file, Problems& problems);
/// Reads the same from a text of `rig_definition`, which needs no other file. `name` replaces the file name in problems.
[[nodiscard]] pipeline::RigConfig read_rig_text(const std::string& text, const std::string& name, Problems& problems);

/// The part of a rig file that a calibration of the centre of pressure depends on.
struct RigToCalibrate {
  physics::RigModel model;
  std::optional<physics::CopCalibration> calibration;     ///< Absent: the rig uses its plate model.
  physics::CopMethod method = physics::CopMethod::Poly3;  ///< Of the calibration, or of the stage `cop`.
};
/// Reads only this part, so that the file needs no stages. Adds every error in it to `problems`.
[[nodiscard]] RigToCalibrate read_rig_to_calibrate(const std::string& file, Problems& problems);

/// Returns a rig file and all files that it names as one TOML text, so that a recording can be computed again without the files. Replaces
/// the names of curves and calibration by tables. Every number reads back as exactly the same double. If the text is longer than 1 MiB,
/// leaves out the points of the calibration: they only document it. Fails with InvalidArgument and the first problem if the rig file has an
/// error, and with LimitExceeded if the text is still too long.
[[nodiscard]] core::Result<std::string> rig_definition(const std::string& file);

}  // namespace dts::files
