// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command_line.h"

namespace dts::lab::cop {

/// Adds `dtslab cop fit`, `cop estimate` and `cop evaluate`.
void add_commands(cli::CommandLine& line);

/// Adds `cop evaluate` to the group `cop`.
void add_evaluate(cli::CommandLine& line, CLI::App& cop);
/// Adds `--estimator NAME`.
void add_estimator(CLI::App& command, std::string& estimator, const std::vector<std::string>& names);

}  // namespace dts::lab::cop
