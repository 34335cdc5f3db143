// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "files/toml_reader.h"
#include "physics/rig_model.h"
#include "pipeline/rig_config.h"
#include "record/recording.h"

namespace dts::lab {

/// Reads the physical part of a rig file; returns the thesis's floor platform if `file` is empty.
[[nodiscard]] physics::RigModel read_rig(const std::string& file, files::Problems& problems);

/// Returns the rig definition that the recording contains. Fails with InvalidArgument if there is none.
[[nodiscard]] core::Result<pipeline::RigConfig> rig_of(const record::Recording& recording, const std::string& name);

}  // namespace dts::lab
