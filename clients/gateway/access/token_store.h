// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "gateway/access/identity.h"

namespace dts::gateway {

/// The logins, by token: 256 random bits as 43 letters of base64url. Only hashes of tokens are kept, so that neither memory nor the time of
/// a comparison reveals a token. Has no clock: the caller passes the time.
class TokenStore {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMost = 1000;
  static constexpr std::size_t kMostOfOne = 20;  ///< Per user: browsers, tablets.

  TokenStore(std::chrono::seconds life, std::chrono::seconds idle_life) : life_(life), idle_life_(idle_life) {}

  /// Returns a new token. If there are too many, drops the one that was unused for longest.
  [[nodiscard]] std::string issue(const Identity& identity, Time now);
  /// Returns the user of a valid token and restarts its idle time.
  [[nodiscard]] std::optional<Identity> use(const std::string& token, Time now);
  void revoke(const std::string& token);
  void revoke_all_of(const std::string& user);

  [[nodiscard]] std::size_t size() const noexcept { return logins_.size(); }

 private:
  using Hash = std::array<unsigned char, 32>;
  struct Login {
    Identity identity;
    Time created;
    Time used;
  };
  [[nodiscard]] static Hash hash_of(const std::string& token) noexcept;
  [[nodiscard]] bool is_over(const Login& login, Time now) const noexcept;
  void make_room(const std::string& user, Time now);

  std::chrono::seconds life_;
  std::chrono::seconds idle_life_;
  std::map<Hash, Login> logins_;
};

}  // namespace dts::gateway
