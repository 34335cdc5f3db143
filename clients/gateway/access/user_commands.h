// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "cli/command_line.h"
#include "dts/error.h"
#include "gateway/access/secret.h"

namespace dts::gateway {

/// Asks for a new password; writes to `console.talk`.
using AskPassword = std::function<client::Result<Secret>(cli::Console& console)>;

/// Reads the password from a terminal twice and without echo; from any other input as one line. `descriptor`: standard input, except in
/// tests.
[[nodiscard]] client::Result<Secret> ask_password(int descriptor, cli::Console& console);

/// Adds the commands `user add NAME --role ROLE`, `user remove NAME` and `user list`, each for the file `--users FILE`. A running gateway
/// with that file detects the change by itself.
void add_user_commands(cli::CommandLine& line, AskPassword ask);

}  // namespace dts::gateway
