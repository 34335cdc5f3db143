// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "settings/endpoint.h"

namespace dts::ipc {

using settings::check_endpoint;

/// Fails with WrongState if a program already listens on this ipc path, and with InvalidArgument if the path is a file but no socket:
/// binding would silently replace either of them. Accepts the socket file that a dead daemon left.
[[nodiscard]] core::Status check_not_in_use(const std::string& endpoint);

/// Returns what to do if an address cannot be bound with this system error; empty if there is no hint.
[[nodiscard]] std::string bind_hint(int system_errno);

/// Removes the file of an ipc endpoint before it is closed, because libzmq does not.
void remove_socket_file(const std::string& endpoint) noexcept;

}  // namespace dts::ipc
