// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "files/toml_reader.h"

namespace dts::files {

/// The model as TOML, format 1. Every number reads back as exactly the same double, so that the model read computes bit for bit what the
/// one written did.
[[nodiscard]] std::string trunk_model_text(const classifier::TrunkModel& model);

/// SHA-256 of everything that the model consists of, however it is written; a model file says it.
[[nodiscard]] std::string trunk_model_sha256(const classifier::TrunkModel& model);

/// Writes `file` whole or not at all. Fails with Failed or NotAllowed, naming the file and why.
[[nodiscard]] core::Status save_trunk_model(const std::string& file, const classifier::TrunkModel& model);

/// Reads and checks everything: versions, feature names, counts, ranges, finiteness, that the training had succeeded, and the checksum if there is one.
/// What is wrong is added to `problems` with file:line:column and nothing is returned.
[[nodiscard]] std::optional<classifier::TrunkModel> load_trunk_model(const std::string& file, Problems& problems);
/// The same of a table that was parsed already: a file's, or one inside a rig definition.
[[nodiscard]] std::optional<classifier::TrunkModel> read_trunk_model(TomlReader& top, Problems& problems);

}  // namespace dts::files
