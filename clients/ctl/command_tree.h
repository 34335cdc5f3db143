// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ctl/arguments.h"
#include "ctl/console.h"

namespace dts::ctl {

struct CommandTree;
/// Executes a command and returns the exit status.
using Handler = int (*)(const CommandTree& tree, Console& console);

/// The commands with their options, help and examples. Help, completion and the manual page are all made from it.
struct CommandTree {
  CLI::App app;
  Arguments arguments;
  std::vector<std::pair<const CLI::App*, Handler>> handlers;
};

/// Bound to itself by pointers: stays where it is made.
[[nodiscard]] std::unique_ptr<CommandTree> make_command_tree();

/// The examples of a command, one "command line  what it does" per element.
struct Example {
  std::string command;
  std::string purpose;
};
[[nodiscard]] std::vector<Example> examples(const CLI::App& command);

/// Visible subcommands, in the order of their definition.
[[nodiscard]] std::vector<const CLI::App*> subcommands(const CLI::App& command);
/// Options that are not positional.
[[nodiscard]] std::vector<const CLI::Option*> options(const CLI::App& command);
[[nodiscard]] std::vector<const CLI::Option*> positionals(const CLI::App& command);
/// "--count N", "--json", "RIG"
[[nodiscard]] std::string option_label(const CLI::Option& option);
/// "dtsctl session start"
[[nodiscard]] std::string full_name(const CLI::App& command);
/// "dtsctl session start --rig RIG [OPTIONS]"
[[nodiscard]] std::string usage(const CLI::App& command);

}  // namespace dts::ctl
