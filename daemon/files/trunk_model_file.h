// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "files/toml_reader.h"

namespace dts::files {

/// Returns the model as TOML, format 1. Every number reads back as exactly the same double, so that the model that is read back gives bit
/// for bit the same results.
[[nodiscard]] std::string trunk_model_text(const classifier::TrunkModel& model);

/// Returns the SHA-256 of the model's content, independent of the layout of the file. A model file contains it as its checksum.
[[nodiscard]] std::string trunk_model_sha256(const classifier::TrunkModel& model);

/// Writes `file` completely or not at all. Fails with Failed or NotAllowed; the message names the file and the reason.
[[nodiscard]] core::Status save_trunk_model(const std::string& file, const classifier::TrunkModel& model);

/// Reads a model and checks everything: versions, feature names, counts, ranges, finite numbers, that the training succeeded, and the
/// checksum if present. If something is wrong, adds it to `problems` with file:line:column and returns nothing.
[[nodiscard]] std::optional<classifier::TrunkModel> load_trunk_model(const std::string& file, Problems& problems);
/// Reads the same from a parsed table: of a file, or inside a rig definition.
[[nodiscard]] std::optional<classifier::TrunkModel> read_trunk_model(TomlReader& top, Problems& problems);

}  // namespace dts::files
