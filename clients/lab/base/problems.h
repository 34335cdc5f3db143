// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "core/result.h"
#include "files/toml_reader.h"

namespace dts::lab {

/// Prints the problems of an input file, one "file:line:column: text" per line, a format that editors can open (the first twenty); returns
/// the exit status for bad input.
[[nodiscard]] int report_problems(cli::Console& console, const files::Problems& problems);

/// Prints an error and returns its exit status. A missing file or folder is bad input; status 5 is only for rigs, devices and sessions.
[[nodiscard]] int fail_with(cli::Console& console, const core::Error& error);

/// Fails with InvalidArgument if writing `out` would overwrite measurements, by any name or link: `out` is one of `inputs`, or belongs to a
/// folder of reaching trials among them.
[[nodiscard]] core::Status check_out(const std::string& out, const std::vector<std::string>& inputs);

/// Prints "warning: text" to `talk`: the result is valid, but with a reservation.
void warn(cli::Console& console, const std::string& text);

}  // namespace dts::lab
