// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::lab {

/// Fails with InvalidArgument unless `file` ends in .svg or .png.
[[nodiscard]] core::Status check_plot_name(const std::string& file);

/// Runs gnuplot with `script` on its standard input and writes what it draws to `file`, whole or not at all. The script draws
/// to the standard output and never sees the file's name; what it must not contain are names from outside either. Fails with
/// Unsupported when gnuplot is not installed, with Failed and gnuplot's own words when it refuses the script.
[[nodiscard]] core::Status draw(const std::string& script, const std::string& file);

}  // namespace dts::lab
