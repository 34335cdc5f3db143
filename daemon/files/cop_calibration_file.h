// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "files/toml_reader.h"
#include "physics/cop/cop_calibration.h"

namespace dts::files {

/// The calibration as TOML, format 1. Its head comments say how to compute with the coefficients; every number reads back as
/// exactly the same double.
[[nodiscard]] std::string cop_calibration_text(const physics::CopCalibration& calibration);

/// Writes `file` whole or not at all: a temporary file beside it, synchronised, then renamed. Fails with Failed, naming the file and why.
[[nodiscard]] core::Status write_cop_calibration(const std::string& file, const physics::CopCalibration& calibration);

/// Reads and checks everything: versions, counts, ranges, finiteness. What is wrong is added to `problems` with file:line:column and
/// nothing is returned. The estimator read computes bit for bit what the one written did.
[[nodiscard]] std::optional<physics::CopCalibration> read_cop_calibration(const std::string& file, Problems& problems);
/// The same of a table that was parsed already: a file's, or one inside a rig definition.
[[nodiscard]] std::optional<physics::CopCalibration> read_cop_calibration(TomlReader& top, Problems& problems);

}  // namespace dts::files
