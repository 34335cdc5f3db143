// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "dts/v1/control.pb.h"

namespace dts::gateway {

/// Who uses the gateway without a login. Nobody else may have this name: nothing could tell them apart.
inline constexpr std::string_view kLocalUser = "local";

/// Who is at the other end of a connection, and what they may do.
struct Identity {
  std::string user;  ///< `kLocalUser`: without a login
  v1::Role role = v1::ROLE_UNSPECIFIED;
  /// False once the login that this came from has ended: a tab may stay open longer.
  std::function<bool()> holds = [] { return true; };
};

[[nodiscard]] inline bool may(const Identity& identity, v1::Role needed) noexcept {
  return needed != v1::ROLE_UNSPECIFIED && identity.role >= needed;
}

}  // namespace dts::gateway
