// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::ipc {

inline constexpr int kHandshakeMs = 2000;  ///< A peer that takes longer to say who it is, is none.

/// Checks an endpoint before libzmq sees it: "ipc:///absolute/path" (short enough for a socket address) or
/// "tcp://127.0.0.1:port". Any other TCP address is refused: nothing leaves this machine without
/// keys. Fails with InvalidArgument and the reason.
[[nodiscard]] core::Status check_endpoint(const std::string& endpoint);
/// The same for an address that other machines may reach, whose clients need keys: "tcp://*:port" or "tcp://address:port".
[[nodiscard]] core::Status check_remote_endpoint(const std::string& endpoint);

/// Fails with WrongState when somebody already listens on this ipc path. libzmq would silently unlink the socket file of
/// a running daemon and take its place, and any other file likewise: that one is refused too. A dead daemon's leftover is not "in use".
/// Other transports: no effect.
[[nodiscard]] core::Status check_not_in_use(const std::string& endpoint);

/// What to do about an address that cannot be bound, by the system's error; empty: nothing is known.
[[nodiscard]] std::string bind_hint(int system_errno);

/// Removes the file of an ipc endpoint that is about to be closed: libzmq leaves it. Other transports: no effect.
void remove_socket_file(const std::string& endpoint) noexcept;

}  // namespace dts::ipc
