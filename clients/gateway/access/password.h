// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "dts/error.h"
#include "gateway/access/secret.h"

namespace dts::gateway {

/// Argon2id as libsodium's INTERACTIVE limits have it: 64 MiB and about a tenth of a second for each hash, made or compared. All hashes
/// have the same limits, so that time tells nothing about them.

inline constexpr std::size_t kFewestPasswordCharacters = 10;
inline constexpr std::size_t kMostPasswordBytes = 200;

/// The rules for new passwords: length is all that counts (NIST SP 800-63B, 5.1.1).
[[nodiscard]] client::Result<void> check_new_password(const Secret& password);
/// "$argon2id$..."; Failed when there is no memory.
[[nodiscard]] client::Result<std::string> hash_password(const Secret& password);
/// Whether `hash` is one that `hash_password` could have made.
[[nodiscard]] bool is_password_hash(const std::string& hash) noexcept;

/// Whether the password is the one that was hashed. Without a hash (nobody of that name) it takes as long and says no.
[[nodiscard]] bool is_password(const std::string& hash, const Secret& password) noexcept;

}  // namespace dts::gateway
