// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::steadiness {

/// Adds `dtslab steadiness train` and `steadiness classify`: distinguish groups or conditions by their measures.
void add_commands(cli::CommandLine& line);

// One function per file.
void add_train(cli::CommandLine& line, CLI::App& steadiness);
void add_classify(cli::CommandLine& line, CLI::App& steadiness);

}  // namespace dts::lab::steadiness
