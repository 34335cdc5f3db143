// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "files/toml_reader.h"
#include "physics/cop/cop_calibration.h"

namespace dts::files {

/// Returns the calibration as TOML, format 1. Comments at its start explain how to compute with the coefficients. Every number reads back
/// as exactly the same double.
[[nodiscard]] std::string cop_calibration_text(const physics::CopCalibration& calibration);

/// Writes `file` completely or not at all, see `write_whole_file`. Fails like `write_whole_file`.
[[nodiscard]] core::Status write_cop_calibration(const std::string& file, const physics::CopCalibration& calibration);

/// Reads a calibration and checks everything: versions, counts, ranges, finite numbers. If something is wrong, adds it to `problems` with
/// file:line:column and returns nothing. A calibration that was written and read back gives bit for bit the same results.
[[nodiscard]] std::optional<physics::CopCalibration> read_cop_calibration(const std::string& file, Problems& problems);
/// Reads the same from a parsed table: of a file, or inside a rig definition.
[[nodiscard]] std::optional<physics::CopCalibration> read_cop_calibration(TomlReader& top, Problems& problems);

}  // namespace dts::files
