// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "dts/v1/control.pb.h"

namespace dts::access {

inline constexpr std::size_t kLongestKeyName = 32;
inline constexpr std::size_t kKeyCharacters = 40;  ///< Length of a CURVE key (32 bytes) in Z85 (ZeroMQ RFC 32).

/// A client on another machine that may connect. The client proves its identity with its secret key, which this daemon never receives.
struct ClientKey {
  std::string name;
  v1::Role role = v1::ROLE_UNSPECIFIED;
  std::string public_key;   ///< Z85.
  std::string created_utc;  ///< "2026-01-31T12:00:00Z"

  friend bool operator==(const ClientKey&, const ClientKey&) = default;
};

/// Returns true for 1 to 32 characters of a-z 0-9 . _ -, but not for "local", the audit trail's name for this machine's local sockets.
[[nodiscard]] bool is_key_name(std::string_view name) noexcept;
/// Returns true for 40 characters of Z85 that encode 32 bytes.
[[nodiscard]] bool is_public_key(std::string_view text);

/// Returns "viewer", "operator" or "engineer"; "none" for any other value.
[[nodiscard]] std::string_view role_word(v1::Role role) noexcept;
[[nodiscard]] std::optional<v1::Role> role_of_word(std::string_view word) noexcept;

}  // namespace dts::access
