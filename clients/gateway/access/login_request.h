// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dts/error.h"
#include "gateway/access/secret.h"

namespace dts::gateway {

struct LoginRequest {
  std::string user;
  Secret password;
};
/// Parses {"user","password"}: both must be texts, and nothing else is allowed. Wipes `body`.
[[nodiscard]] client::Result<LoginRequest> read_login(std::string& body);

}  // namespace dts::gateway
