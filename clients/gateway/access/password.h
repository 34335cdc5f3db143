// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "dts/error.h"
#include "gateway/access/secret.h"

namespace dts::gateway {

/// Argon2id with libsodium's INTERACTIVE limits: each hash, computed or compared, needs 64 MiB and about a tenth of a second. All hashes
/// have the same limits, so that the time reveals nothing about them.

inline constexpr std::size_t kFewestPasswordCharacters = 10;
inline constexpr std::size_t kMostPasswordBytes = 200;

/// Checks a new password: only its length counts (NIST SP 800-63B, 5.1.1).
[[nodiscard]] client::Result<void> check_new_password(const Secret& password);
/// Returns "$argon2id$..."; fails with Failed if there is not enough memory.
[[nodiscard]] client::Result<std::string> hash_password(const Secret& password);
/// Returns true if `hash` has the form of a result of `hash_password`.
[[nodiscard]] bool is_password_hash(const std::string& hash) noexcept;

/// Returns true if `password` matches `hash`. Without a hash (no user of that name) it needs the same time and returns false.
[[nodiscard]] bool is_password(const std::string& hash, const Secret& password) noexcept;

}  // namespace dts::gateway
