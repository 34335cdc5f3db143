// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "files/toml_reader.h"
#include "fleet/worker/worker.h"

namespace dts::fleet::worker {

/// Reads worker.toml. Adds errors to `problems`. The result is complete if there are none.
[[nodiscard]] WorkerOptions read_settings(const std::string& file, files::Problems& problems);

}  // namespace dts::fleet::worker
