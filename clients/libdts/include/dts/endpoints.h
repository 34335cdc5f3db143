// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "dts/error.h"

namespace dts::client {

/// Where a daemon listens, as ZeroMQ addresses: "ipc:///run/dtsd/control.sock" or "tcp://127.0.0.1:5555".
struct Endpoints {
  std::string control;
  std::string data;    ///< Empty when only a TCP control address is known: the port of the other socket cannot be guessed.
  std::string origin;  ///< What decided it, for messages: "--endpoint", "DTSD_CONTROL", "DTSD_RUNTIME_DIR", "/run/dtsd", ...
};

/// Addresses given by the user; empty: find them.
struct EndpointWishes {
  std::string control;
  std::string data;
};

/// The value of an environment variable, or nullptr.
using Environment = std::function<const char*(const char* name)>;
[[nodiscard]] const char* process_environment(const char* name) noexcept;

/// Finds the daemon by the rule that dtsd itself follows. First match wins:
///
///     wishes > DTSD_CONTROL, DTSD_DATA > DTSD_RUNTIME_DIR > /run/dtsd if its sockets exist
///            > XDG_RUNTIME_DIR/dtsd > /tmp/dtsd-<uid>
///
/// One address given as ".../control.sock" or ".../data.sock" decides the other, so that two daemons never mix.
/// Contacts nobody. Fails with InvalidArgument for an address that no daemon can have, and with NotAllowed when the
/// directory below /tmp belongs to another user.
[[nodiscard]] Result<Endpoints> find_endpoints(const EndpointWishes& wishes = {}, const Environment& environment = process_environment,
                                               const std::filesystem::path& system_directory = "/run/dtsd");

/// Tries to connect to an ipc address and hangs up again: tells at once, and with the reason, that nobody listens.
/// Fails with Unreachable or NotAllowed. Other transports succeed untried.
[[nodiscard]] Result<void> probe(const std::string& endpoint);

}  // namespace dts::client
