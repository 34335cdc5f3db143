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

/// Where the daemon is, and with which key to come.
struct Target {
  client::Endpoints endpoints;
  std::optional<client::Key> key;
};
/// What the arguments and the environment give. The addresses in a key file count unless others are given.
[[nodiscard]] client::Result<Target> target(const Arguments& arguments);
/// A client with the time-outs of the arguments.
[[nodiscard]] client::Result<client::ControlClient> connect(const Arguments& arguments);

/// The rig of that name; fails with NotFound, naming those there are.
[[nodiscard]] client::Result<v1::RigStatus> find_rig(const v1::StatusSnapshot& status, const std::string& name);

}  // namespace dts::ctl
