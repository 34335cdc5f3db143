// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/password.h"

#include <sodium.h>

#include <array>

#include "core/utf8.h"

namespace dts::gateway {
namespace {

constexpr auto kOperations = crypto_pwhash_argon2id_OPSLIMIT_INTERACTIVE;
constexpr auto kMemoryBytes = crypto_pwhash_argon2id_MEMLIMIT_INTERACTIVE;

}  // namespace

client::Result<void> check_new_password(const Secret& password) {
  const auto text = password.text();
  if (core::character_count(text) < kFewestPasswordCharacters) {
    return client::fail(client::ErrorCode::InvalidArgument, "a password has at least 10 characters", "use a short sentence");
  }
  if (text.size() > kMostPasswordBytes) {
    return client::fail(client::ErrorCode::InvalidArgument, "a password has at most 200 bytes");
  }
  return {};
}

client::Result<std::string> hash_password(const Secret& password) {
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  const auto text = password.text();
  if (sodium_init() < 0 ||
      crypto_pwhash_str_alg(hash.data(), text.data(), text.size(), kOperations, kMemoryBytes, crypto_pwhash_ALG_ARGON2ID13) != 0) {
    return client::fail(client::ErrorCode::Failed, "the password cannot be hashed: it takes 64 MiB of memory");
  }
  return std::string(hash.data());
}

bool is_password_hash(const std::string& hash) noexcept {
  // libsodium reads up to a NUL, so a text with a NUL is not a valid hash.
  return hash.size() < crypto_pwhash_STRBYTES && hash.find('\0') == std::string::npos &&
         hash.starts_with(crypto_pwhash_argon2id_STRPREFIX) && crypto_pwhash_str_needs_rehash(hash.c_str(), kOperations, kMemoryBytes) == 0;
}

bool is_password(const std::string& hash, const Secret& password) noexcept {
  const auto text = password.text();
  if (is_password_hash(hash)) return crypto_pwhash_str_verify(hash.c_str(), text.data(), text.size()) == 0;
  std::array<unsigned char, crypto_pwhash_SALTBYTES> salt{};
  std::array<unsigned char, 32> unused{};
  randombytes_buf(salt.data(), salt.size());
  // The result is always false; the hash is computed only to need the same time.
  [[maybe_unused]] const int ended = crypto_pwhash(unused.data(), unused.size(), text.data(), text.size(), salt.data(), kOperations,
                                                   kMemoryBytes, crypto_pwhash_ALG_ARGON2ID13);
  return false;
}

}  // namespace dts::gateway
