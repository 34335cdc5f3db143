// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/token_store.h"

#include <sodium.h>

#include <algorithm>

namespace dts::gateway {

TokenStore::Hash TokenStore::hash_of(const std::string& token) noexcept {
  Hash hash{};
  static_assert(sizeof(Hash) == crypto_generichash_BYTES);
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(token.data()), token.size(), nullptr, 0);
  return hash;
}

bool TokenStore::is_over(const Login& login, Time now) const noexcept {
  return now - login.created >= life_ || now - login.used >= idle_life_;
}

void TokenStore::make_room(const std::string& user, Time now) {
  std::erase_if(logins_, [&](const auto& entry) { return is_over(entry.second, now); });
  const auto is_of_user = [&user](const auto& entry) { return entry.second.identity.user == user; };
  const bool user_has_too_many = static_cast<std::size_t>(std::ranges::count_if(logins_, is_of_user)) >= kMostOfOne;
  if (!user_has_too_many && logins_.size() < kMost) return;
  auto oldest = logins_.end();
  for (auto entry = logins_.begin(); entry != logins_.end(); ++entry) {
    if (user_has_too_many && !is_of_user(*entry)) continue;
    if (oldest == logins_.end() || entry->second.used < oldest->second.used) oldest = entry;
  }
  logins_.erase(oldest);
}

std::string TokenStore::issue(const Identity& identity, Time now) {
  constexpr int kVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
  make_room(identity.user, now);
  std::array<unsigned char, 32> random{};
  randombytes_buf(random.data(), random.size());
  std::array<char, sodium_base64_ENCODED_LEN(32, kVariant)> text{};
  sodium_bin2base64(text.data(), text.size(), random.data(), random.size(), kVariant);
  std::string token(text.data());
  logins_[hash_of(token)] = {.identity = identity, .created = now, .used = now};
  return token;
}

std::optional<Identity> TokenStore::use(const std::string& token, Time now) {
  if (token.empty()) return std::nullopt;
  const auto found = logins_.find(hash_of(token));
  if (found == logins_.end()) return std::nullopt;
  if (is_over(found->second, now)) {
    logins_.erase(found);
    return std::nullopt;
  }
  found->second.used = now;
  return found->second.identity;
}

void TokenStore::revoke(const std::string& token) { logins_.erase(hash_of(token)); }

void TokenStore::revoke_all_of(const std::string& user) {
  std::erase_if(logins_, [&user](const auto& entry) { return entry.second.identity.user == user; });
}

}  // namespace dts::gateway
