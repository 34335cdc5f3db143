// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/console.h"
#include "ctl/arguments.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// `dtsctl key`: who may connect from other machines. Each returns the exit status.
[[nodiscard]] int run_key_new(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_key_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_key_revoke(const Arguments& arguments, cli::Console& console);

/// What a client dials: the address on which a daemon listens, "tcp://*:5555", with `host` in place of "every address of this machine".
/// Empty for an empty one.
[[nodiscard]] std::string dialled(const std::string& endpoint, const std::string& host);

void print_keys(cli::Console& console, const v1::ListKeysResponse& keys);

}  // namespace dts::ctl
