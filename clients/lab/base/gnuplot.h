// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::lab {

/// Fails with InvalidArgument if `file` does not end in .svg or .png.
[[nodiscard]] core::Status check_plot_name(const std::string& file);

/// Runs gnuplot with `script` on its standard input and writes the picture to `file`, completely or not at all. The script must draw to the
/// standard output and must contain neither the file's name nor any other name from outside. Fails with Unsupported if gnuplot is not
/// installed, and with Failed and gnuplot's own message if gnuplot rejects the script.
[[nodiscard]] core::Status draw(const std::string& script, const std::string& file);

}  // namespace dts::lab
