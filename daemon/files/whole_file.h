// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::files {

/// Writes `path` whole or not at all, also when the power fails: a temporary file beside it, synchronised, renamed over it, the folder
/// synchronised. Links are followed, rights kept; a new file gets `new_mode` less the umask. What is no ordinary file (a pipe, a device) is
/// written to instead of replaced. Fails with Failed or NotAllowed, naming the file and why; then the old file is untouched.
[[nodiscard]] core::Status write_whole_file(const std::string& path, std::string_view text, mode_t new_mode = 0666);

/// All of a regular file. Never waits for whoever may write to a pipe: Fails with InvalidArgument, saying why but not naming the file, when
/// it cannot be read, is no regular file (a folder, a pipe, a device), or is larger than `most_bytes`.
[[nodiscard]] core::Result<std::string> read_whole_file(const std::string& path, std::size_t most_bytes);

}  // namespace dts::files
