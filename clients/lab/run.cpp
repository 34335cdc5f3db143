// SPDX-License-Identifier: Apache-2.0
#include "lab/run.h"

#include "cli/run.h"
#include "lab/command_tree.h"

namespace dts::lab {

int run(const std::vector<std::string>& arguments, cli::Console& console) {
  const auto tree = make_command_tree();
  return cli::run(*tree, arguments, console);
}

}  // namespace dts::lab
