// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::settings {

/// Checks an endpoint of dtsd itself, before a socket uses it: "ipc:///absolute/path", short enough for a socket address. Rejects TCP:
/// other machines are served by dts-relay. Fails with InvalidArgument and the reason.
[[nodiscard]] core::Status check_endpoint(const std::string& endpoint);
/// Checks an endpoint of dts-relay, whose clients need keys: "tcp://*:port" or "tcp://address:port". Fails like `check_endpoint`.
[[nodiscard]] core::Status check_remote_endpoint(const std::string& endpoint);

}  // namespace dts::settings
