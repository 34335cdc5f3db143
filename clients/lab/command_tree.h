// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "cli/command_line.h"
#include "lab/arguments.h"

namespace dts::lab {

/// dtslab's commands, and where their arguments arrive.
struct CommandTree {
  Arguments arguments;
  cli::CommandLine line{{.name = "dtslab",
                         .version = DTS_VERSION,
                         .description = "Offline laboratory of dtsd: plates, centre of pressure, the thesis's tables",
                         .examples = "dtslab plate solve case.toml | bend a plate\n"
                                     "dtslab thesis 4.1 | the thesis's figures beside ours\n"
                                     "dtslab cop fit points.csv --rig rig.toml --out cal.toml | calibrate a platform\n"
                                     "dtslab cop evaluate --noise realistic | what to expect of it\n"
                                     "dtslab compare plate.csv force_plate.csv | two instruments, one person\n"
                                     "dtslab place | where sensors belong\n"
                                     "dtslab simulate floor --duration 60 --out standing.xdf | synthetic data\n"
                                     "dtslab replay standing.xdf | is what was recorded what the stages compute?\n",
                         .takes_files = true}};
};

/// Bound to itself by pointers: stays where it is made.
[[nodiscard]] std::unique_ptr<CommandTree> make_command_tree();

}  // namespace dts::lab
