// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "dts/error.h"
#include "dts/export.h"

namespace dts::client {

/// Where a daemon listens, as ZeroMQ addresses: "ipc:///run/dtsd/control.sock" or "tcp://127.0.0.1:5555".
struct Endpoints {
  std::string control;  ///< Address of the control socket, for `ControlClient`.
  std::string data;    ///< Address of the data socket, for `Subscriber`. Empty if only a TCP control address is known: the port of the data
                       ///< socket cannot be guessed.
  std::string origin;  ///< What decided the addresses, for messages: "--endpoint", "DTSD_CONTROL", "DTSD_RUNTIME_DIR", "/run/dtsd", ...
};

/// Addresses from the user. An empty one is looked up.
struct EndpointWishes {
  std::string control;  ///< Wanted `Endpoints::control`.
  std::string data;     ///< Wanted `Endpoints::data`.
};

/// Returns the value of an environment variable, or nullptr.
using Environment = std::function<const char*(const char* name)>;
/// Returns the value of a variable of this process, or nullptr. Thread: any, while no thread changes the environment.
[[nodiscard]] DTS_API const char* process_environment(const char* name) noexcept;

/// Finds the daemon's addresses by the same rule that dtsd follows. `environment` and `system_directory` are parameters for tests. The
/// first match wins:
///
///     wishes > DTSD_CONTROL, DTSD_DATA > DTSD_RUNTIME_DIR > /run/dtsd if its sockets exist
///            > XDG_RUNTIME_DIR/dtsd > /tmp/dtsd-<uid>
///
/// One address in the form ".../control.sock" or ".../data.sock" decides the other one, so that addresses of two daemons never mix. Does
/// not connect. Fails with InvalidArgument for an address that no daemon can have, and with NotAllowed if the directory below /tmp belongs
/// to another user. Thread: any, while no thread changes the environment.
[[nodiscard]] DTS_API Result<Endpoints> find_endpoints(const EndpointWishes& wishes = {},
                                                       const Environment& environment = process_environment,
                                                       const std::filesystem::path& system_directory = "/run/dtsd");

/// Connects to an ipc address and disconnects again, to report at once, and with the reason, that no daemon listens there. Fails with
/// Unreachable or NotAllowed. Succeeds for other transports without connecting. Thread: any.
[[nodiscard]] DTS_API Result<void> probe(const std::string& endpoint);

}  // namespace dts::client
