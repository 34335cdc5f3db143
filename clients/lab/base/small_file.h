// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::lab {

/// Reads a file of at most 16 MiB. Fails with InvalidArgument, naming the file.
[[nodiscard]] core::Result<std::string> read_small_file(const std::string& file);

}  // namespace dts::lab
