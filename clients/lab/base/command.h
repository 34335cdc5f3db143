// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cli/command_line.h"

namespace dts::lab {

/// A command of dtslab, and the variables that receive its arguments. Both live as long as the command line.
template <typename Arguments>
struct Command {
  CLI::App& app;
  Arguments& arguments;
};

/// Adds a command with arguments of its own: `run` receives them and returns the exit status.
template <typename Arguments>
Command<Arguments> add_command(cli::CommandLine& line, CLI::App& parent, const std::string& name, const std::string& description,
                               const std::string& examples, int (*run)(const Arguments& arguments, cli::Console& console)) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* app = cli::add_command(line, parent, name, description, examples,
                                   [arguments, run](cli::Console& console) { return run(*arguments, console); });
  return {*app, *arguments};
}

// Options that several commands have.

void add_json(CLI::App& command, bool& is_json);
/// Adds `--plot FILE`; `what` is the beginning of its description.
void add_plot(CLI::App& command, std::string& file, const std::string& what);
/// Adds `--linear`: without the plate's stiffening by stretching.
void add_linear(CLI::App& command, bool& is_linear);
/// Adds `--seed N`, a whole number of 32 bits.
void add_seed(CLI::App& command, std::uint32_t& seed, const std::string& what);
/// Adds `--rig FILE`, which may be missing.
void add_rig(CLI::App& command, std::string& file, const std::string& what);

}  // namespace dts::lab
