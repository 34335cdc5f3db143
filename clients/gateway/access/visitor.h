// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateway/http/http_message.h"

namespace dts::gateway {

/// Returns true if the request was sent on this machine: from 127.0.0.0/8 or ::1, and not through a proxy, because a proxy
/// forwards requests from other machines.
[[nodiscard]] bool is_local(const HttpRequest& request);

/// The same, or if the request came from the machine's own address to which it was sent: a local monitor uses that address if the gateway
/// listens only there.
[[nodiscard]] bool is_same_machine(const HttpRequest& request);

}  // namespace dts::gateway
