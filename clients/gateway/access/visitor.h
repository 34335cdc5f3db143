// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateway/http/http_message.h"

namespace dts::gateway {

/// Whether somebody at this machine asks: from 127.0.0.0/8 or ::1, and not through a proxy, behind which anybody may be.
[[nodiscard]] bool is_local(const HttpRequest& request);

/// The same, or from the address of this machine that was asked at: what a monitor here has when the gateway listens on that one only.
[[nodiscard]] bool is_same_machine(const HttpRequest& request);

}  // namespace dts::gateway
