// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/audit_chain.h"

#include <sodium.h>

#include <array>
#include <string_view>

namespace dts::record {
namespace {

constexpr std::size_t kAuditHashLetters = std::size_t{2} * crypto_hash_sha256_BYTES;

void add_bytes(crypto_hash_sha256_state& state, std::string_view bytes) {
  crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

void add_field(crypto_hash_sha256_state& state, const std::string& text) {
  std::array<char, 8> length{};
  for (unsigned index = 0; index < length.size(); ++index) {
    length[index] = static_cast<char>((std::uint64_t{text.size()} >> (8U * index)) & 0xffU);
  }
  add_bytes(state, {length.data(), length.size()});
  add_bytes(state, text);
}

}  // namespace

std::string audit_hash(const std::string& before, const AuditEntry& entry) {
  crypto_hash_sha256_state state;
  crypto_hash_sha256_init(&state);
  add_bytes(state, before);
  for (const std::string& text :
       {std::to_string(entry.number), std::to_string(entry.utc_ns), entry.who, entry.what, entry.target, entry.result}) {
    add_field(state, text);
  }
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256_final(&state, digest.data());
  std::array<char, kAuditHashLetters + 1> letters{};
  sodium_bin2hex(letters.data(), letters.size(), digest.data(), digest.size());
  return letters.data();
}

std::string first_audit_hash() { return std::string(kAuditHashLetters, '0'); }

}  // namespace dts::record
