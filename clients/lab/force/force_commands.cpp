// SPDX-License-Identifier: Apache-2.0
#include "lab/force/force_commands.h"

namespace dts::lab::force {

void add_commands(cli::CommandLine& line) {
  add_force(line);
  add_grf(line);
}

}  // namespace dts::lab::force
