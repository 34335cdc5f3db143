// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "cli/command_line.h"
#include "lab/arguments.h"

namespace dts::lab {

/// The commands of dtslab, and the variables that receive their arguments.
struct CommandTree {
  Arguments arguments;
  cli::CommandLine line{{.name = "dtslab",
                         .version = DTS_VERSION,
                         .description = "Offline laboratory of dtsd: plates, centre of pressure, the thesis's tables",
                         .examples = "dtslab plate solve case.toml | bend a plate\n"
                                     "dtslab thesis 4.1 | compare our values with the thesis\n"
                                     "dtslab cop fit points.csv --rig rig.toml --out cal.toml | calibrate a platform\n"
                                     "dtslab cop evaluate --noise realistic | expected error of a platform\n"
                                     "dtslab compare plate.csv force_plate.csv | compare two instruments\n"
                                     "dtslab place | best sensor positions\n"
                                     "dtslab sway standing.csv | measure sway\n"
                                     "dtslab simulate floor --duration 60 --out standing.xdf | make synthetic data\n"
                                     "dtslab replay standing.xdf | check that the recorded values can be recomputed\n",
                         .takes_files = true}};
};

using Command = int (*)(const Arguments& arguments, cli::Console& console);

/// Adds a command of dtslab: `handler` receives the arguments of the command line.
CLI::App* add_command(CommandTree& tree, CLI::App& parent, const std::string& name, const std::string& description,
                      const std::string& examples, Command handler);
void add_json(CLI::App& command, Arguments& arguments);

/// The object must not move: its parts point to each other.
[[nodiscard]] std::unique_ptr<CommandTree> make_command_tree();

}  // namespace dts::lab
