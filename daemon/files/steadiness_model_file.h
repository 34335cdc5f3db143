// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "files/toml_reader.h"
#include "pipeline/rig_config.h"

namespace dts::files {

/// Reads the table [steadiness] of a rig file: `model`, a file of `dtslab steadiness train` (relative to the rig file; in a rig definition
/// the text of the file), and `trials`, the labels of the trials that it decides. Adds every error to `problems`, also if the label of the
/// model is not told. Returns nothing without the table, or after an error.
[[nodiscard]] std::optional<pipeline::SteadinessModel> read_steadiness_model(TomlReader& top, References references);

}  // namespace dts::files
