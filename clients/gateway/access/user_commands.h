// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "cli/command_line.h"
#include "dts/error.h"
#include "gateway/access/secret.h"

namespace dts::gateway {

/// Asks for a new password; talks to `console.talk`.
using AskPassword = std::function<client::Result<Secret>(cli::Console& console)>;

/// From a terminal twice and without echo; from anything else one line. `descriptor`: of the standard input, but for tests.
[[nodiscard]] client::Result<Secret> ask_password(int descriptor, cli::Console& console);

/// The commands `user add NAME --role ROLE`, `user remove NAME` and `user list`, each for the file `--users FILE`. A gateway that runs with
/// that file takes notice by itself.
void add_user_commands(cli::CommandLine& line, AskPassword ask);

}  // namespace dts::gateway
