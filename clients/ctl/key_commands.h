// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/console.h"
#include "ctl/arguments.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Commands of `dtsctl key`: which clients may connect from other machines. Each returns the exit status.
[[nodiscard]] int run_key_new(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_key_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_key_revoke(const Arguments& arguments, cli::Console& console);

/// Returns the address that a client connects to: the address on which the daemon listens, "tcp://*:5555", with `host` instead of "*".
/// Returns an empty text for an empty address.
[[nodiscard]] std::string dialled(const std::string& endpoint, const std::string& host);

void print_keys(cli::Console& console, const v1::ListKeysResponse& keys);

}  // namespace dts::ctl
