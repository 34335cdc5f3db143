// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ctl/command_tree.h"
#include "ctl/console.h"
#include "dts/control_client.h"
#include "dts/endpoints.h"

namespace dts::ctl {

/// Commands that send one request and print its answer. Each returns the exit status.
[[nodiscard]] int run_status(const CommandTree& tree, Console& console);
[[nodiscard]] int run_rig_list(const CommandTree& tree, Console& console);
[[nodiscard]] int run_rig_show(const CommandTree& tree, Console& console);
[[nodiscard]] int run_device_list(const CommandTree& tree, Console& console);
[[nodiscard]] int run_device_test(const CommandTree& tree, Console& console);
[[nodiscard]] int run_session_start(const CommandTree& tree, Console& console);
[[nodiscard]] int run_session_stop(const CommandTree& tree, Console& console);
[[nodiscard]] int run_mark(const CommandTree& tree, Console& console);
[[nodiscard]] int run_tare(const CommandTree& tree, Console& console);

/// The addresses that the arguments and the environment give.
[[nodiscard]] client::Result<client::Endpoints> endpoints(const Arguments& arguments);
/// A client with the time-outs of the arguments.
[[nodiscard]] client::Result<client::ControlClient> connect(const Arguments& arguments);
/// Prints the error; returns its exit status.
[[nodiscard]] int fail_with(Console& console, const client::Error& error);

}  // namespace dts::ctl
