// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "cli/command_line.h"
#include "ctl/arguments.h"
#include "dts/error.h"

namespace dts::ctl {

/// dtsctl's commands, and the arguments that they fill in.
struct CommandTree {
  Arguments arguments;
  cli::CommandLine line{{.name = "dtsctl",
                         .version = std::string(client::version()),
                         .description = "Command line of dtsd, the distributive tactile sensing daemon",
                         .examples = "dtsctl status | state of daemon, rigs and session\n"
                                     "dtsctl watch floor/cop | see the centre of pressure live\n"
                                     "dtsctl session start --rig floor --protocol romberg | start a session\n"
                                     "dtsctl mark \"eyes closed\" | put a note at this moment\n"
                                     "dtsctl session stop | stop the session\n"
                                     "dtsctl session list | list the recorded sessions\n"
                                     "dtsctl tare --rig floor | tare the empty plate\n"
                                     "dtsctl doctor | find problems and how to fix them\n",
                         .takes_files = true}};
};

using Command = int (*)(const Arguments& arguments, cli::Console& console);

/// Adds a command of dtsctl. `handler` receives the arguments of the command line.
CLI::App* add(CommandTree& tree, CLI::App& parent, const std::string& name, const std::string& description, const std::string& examples,
              Command handler);

/// Returns a tree that holds pointers to itself, so it must not be moved.
[[nodiscard]] std::unique_ptr<CommandTree> make_command_tree();

}  // namespace dts::ctl
