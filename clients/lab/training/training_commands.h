// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::training {

/// Adds `reach train`, `reach classify`, `reach judge`, `reach export` and `reach import` to the group `reach`.
void add_commands(cli::CommandLine& line, CLI::App& reach);

// One function per file.
void add_train(cli::CommandLine& line, CLI::App& reach);
void add_classify(cli::CommandLine& line, CLI::App& reach);
void add_judge(cli::CommandLine& line, CLI::App& reach);
void add_exchange(cli::CommandLine& line, CLI::App& reach);

}  // namespace dts::lab::training
