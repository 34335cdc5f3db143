// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::gateway {

/// Returns the daemon's request id, 64 letters, for the command that the browser of `user` calls `browsers_id`. A repeat has the same id,
/// also over another connection or after a restart of the gateway; ids of different users always differ.
[[nodiscard]] std::string command_id(const std::string& user, const std::string& browsers_id);

}  // namespace dts::gateway
