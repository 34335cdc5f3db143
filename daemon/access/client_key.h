// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "dts/v1/control.pb.h"

namespace dts::access {

inline constexpr std::size_t kLongestKeyName = 32;
inline constexpr std::size_t kKeyCharacters = 40;  ///< Of a CURVE key in Z85 (ZeroMQ RFC 32): 32 bytes.

/// A client on another machine that may connect. It proves that it is the one by its secret half, which this daemon never sees.
struct ClientKey {
  std::string name;
  v1::Role role = v1::ROLE_UNSPECIFIED;
  std::string public_key;   ///< Z85.
  std::string created_utc;  ///< "2026-01-31T12:00:00Z"

  friend bool operator==(const ClientKey&, const ClientKey&) = default;
};

/// 1..32 of a-z 0-9 . _ -, and not "local", which is what the audit trail calls this machine's own sockets.
[[nodiscard]] bool is_key_name(std::string_view name) noexcept;
/// 40 characters that stand for 32 bytes.
[[nodiscard]] bool is_public_key(std::string_view text);

/// "viewer", "operator", "engineer"; "none" for what is no role.
[[nodiscard]] std::string_view role_word(v1::Role role) noexcept;
[[nodiscard]] std::optional<v1::Role> role_of_word(std::string_view word) noexcept;

}  // namespace dts::access
