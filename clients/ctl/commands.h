// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cli/console.h"
#include "ctl/arguments.h"
#include "dts/control_client.h"
#include "dts/endpoints.h"
#include "dts/key.h"

namespace dts::ctl {

/// Commands that send one request and print its answer. Each returns the exit status.
[[nodiscard]] int run_status(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_rig_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_rig_show(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_device_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_device_test(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_mark(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_tare(const Arguments& arguments, cli::Console& console);

/// The daemon's addresses, and the key to connect with.
struct Target {
  client::Endpoints endpoints;
  std::optional<client::Key> key;
};
/// Returns the target from the arguments and the environment. Addresses from the arguments override those in a key file.
[[nodiscard]] client::Result<Target> target(const Arguments& arguments);
/// Returns a client with the time limit from the arguments.
[[nodiscard]] client::Result<client::ControlClient> connect(const Arguments& arguments);

/// Returns the rig with this name. Fails with NotFound, naming the existing rigs.
[[nodiscard]] client::Result<v1::RigStatus> find_rig(const v1::StatusSnapshot& status, const std::string& name);

}  // namespace dts::ctl
