// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::ipc {

inline constexpr int kHandshakeMs = 2000;  ///< Longest time for a peer's handshake; then the connection ends.

/// Checks a local endpoint before libzmq uses it: "ipc:///absolute/path" (short enough for a socket address) or "tcp://127.0.0.1:port".
/// Rejects any other TCP address, because other machines need keys. Fails with InvalidArgument and the reason.
[[nodiscard]] core::Status check_endpoint(const std::string& endpoint);
/// Checks an endpoint for other machines, whose clients need keys: "tcp://*:port" or "tcp://address:port". Fails like `check_endpoint`.
[[nodiscard]] core::Status check_remote_endpoint(const std::string& endpoint);

/// Fails with WrongState if a program already listens on this ipc path, and with InvalidArgument if the path is a file but no socket:
/// libzmq would silently delete either of them. Accepts the socket file that a dead daemon left. Does nothing for other transports.
[[nodiscard]] core::Status check_not_in_use(const std::string& endpoint);

/// Returns what to do if an address cannot be bound with this system error; empty if there is no hint.
[[nodiscard]] std::string bind_hint(int system_errno);

/// Removes the file of an ipc endpoint before it is closed, because libzmq does not. Does nothing for other transports.
void remove_socket_file(const std::string& endpoint) noexcept;

}  // namespace dts::ipc
