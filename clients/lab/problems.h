// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "core/result.h"
#include "files/toml_reader.h"

namespace dts::lab {

/// Prints what is wrong with an input file, one "file:line:column: text" per line as editors jump to (the first twenty);
/// returns the exit status for bad input.
[[nodiscard]] int report_problems(cli::Console& console, const files::Problems& problems);

/// Prints an error and returns its exit status. A file or folder that is not there is bad input: 5 is for rigs, devices and sessions.
[[nodiscard]] int fail_with(cli::Console& console, const core::Error& error);

/// Writing over what is read would destroy measurements, by whatever name or link: InvalidArgument when `out` would destroy what is read: it is one of `inputs`, or belongs to a folder of reaching trials among
/// them.
[[nodiscard]] core::Status check_out(const std::string& out, const std::vector<std::string>& inputs);

/// "warning: text" to `talk`: the result stands, but not without a doubt.
void warn(cli::Console& console, const std::string& text);

}  // namespace dts::lab
