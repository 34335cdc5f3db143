// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/exit_status.h"
#include "ctl/commands.h"
#include "ctl/json.h"

namespace dts::ctl {

/// Connects, sends the request with `ask`, and prints the answer as JSON or with `view`.
template <class Ask, class View>
[[nodiscard]] int ask_and_print(const Arguments& arguments, cli::Console& console, Ask&& ask, View&& view) {
  auto dts = connect(arguments);
  if (!dts) return cli::fail_with(console, dts.error());
  const auto answer = ask(*dts);
  if (!answer) return cli::fail_with(console, answer.error());
  if (arguments.is_json) {
    console.out << cli::document(to_json(*answer));
  } else {
    view(*answer);
  }
  console.out.flush();
  return cli::kOk;
}

}  // namespace dts::ctl
