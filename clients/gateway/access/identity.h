// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "dts/v1/control.pb.h"

namespace dts::gateway {

/// The name of the user without a login. No other user may have this name, because the two would be indistinguishable.
inline constexpr std::string_view kLocalUser = "local";

/// The user of a connection, and the user's role.
struct Identity {
  std::string user;  ///< `kLocalUser` if not logged in
  v1::Role role = v1::ROLE_UNSPECIFIED;
  /// Returns false after this user's login has ended: a tab may stay open longer.
  std::function<bool()> holds = [] { return true; };
};

[[nodiscard]] inline bool may(const Identity& identity, v1::Role needed) noexcept {
  return needed != v1::ROLE_UNSPECIFIED && identity.role >= needed;
}

}  // namespace dts::gateway
