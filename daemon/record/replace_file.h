// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::record {

/// Writes a small file as a whole: after a power failure it has the old or the new content. The new content is on the disk when this
/// returns. `mode`: of the file. Fails with the system's reason; the old file then stays. Thread: one for each file.
[[nodiscard]] core::Status replace_file(const std::string& file, std::string_view text, mode_t mode);

/// Makes the names in a folder durable: new, renamed and removed files.
void synchronise_folder(const std::string& folder) noexcept;

}  // namespace dts::record
