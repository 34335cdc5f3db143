// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::device::bytes {

/// Splits a command into program and arguments: blanks separate, '...' and "..." keep blanks. There is no shell: no variable, no pattern,
/// no backslash. Fails with InvalidArgument if it is empty or a quote is not closed.
[[nodiscard]] core::Result<std::vector<std::string>> split_command(std::string_view command);

}  // namespace dts::device::bytes
