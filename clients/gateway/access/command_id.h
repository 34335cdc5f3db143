// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::gateway {

/// The request id under which the daemon gets a command of `user` that the browser calls `browsers_id`, 64 letters: the same for a repeat,
/// also over another connection or after a restart of the gateway, and no other user's.
[[nodiscard]] std::string command_id(const std::string& user, const std::string& browsers_id);

}  // namespace dts::gateway
