// SPDX-License-Identifier: Apache-2.0
#include "record/sha256.h"

#include "record/xdf/durable_file.h"

namespace dts::record {

std::string sha256_of(std::string_view text) {
  crypto_hash_sha256_state state{};
  crypto_hash_sha256_init(&state);
  crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(text.data()), text.size());
  return hexadecimal_sha256(state);
}

}  // namespace dts::record
