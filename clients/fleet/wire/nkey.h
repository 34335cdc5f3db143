// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::fleet::wire {

/// The key of a user of nats-server: Ed25519, written in base32 with a checksum (NATS "nkeys", prefix U for the public half, SU for the
/// seed).
struct NKey {
  std::string public_key;  ///< "UA...", 56 characters.
  std::string seed;        ///< "SU...", 58 characters. Secret.
};

[[nodiscard]] NKey create_nkey();
/// Returns the key of a seed. Fails with InvalidArgument if the text is not a user's seed.
[[nodiscard]] core::Result<NKey> nkey_of_seed(std::string_view seed);
/// Returns the signature of a text, as the server expects it: base64 for addresses, without padding. Fails like `nkey_of_seed`.
[[nodiscard]] core::Result<std::string> signature(std::string_view seed, std::string_view text);
[[nodiscard]] bool is_public_nkey(std::string_view text);

/// Reads the key from a file that only its owner can read. Fails with NotFound, with NotAllowed if others can read the file, and with
/// InvalidArgument if it is not a key.
[[nodiscard]] core::Result<NKey> read_nkey(const std::string& file);
/// Returns the key in the file; if there is no file, creates it with a new key and mode 0600.
[[nodiscard]] core::Result<NKey> read_or_create_nkey(const std::string& file);

}  // namespace dts::fleet::wire
