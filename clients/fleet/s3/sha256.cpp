// SPDX-License-Identifier: Apache-2.0
#include "fleet/s3/sha256.h"

#include <openssl/evp.h>

#include <array>

namespace dts::fleet::s3 {

void Sha256::Free::operator()(evp_md_ctx_st* state) const { EVP_MD_CTX_free(state); }

Sha256::Sha256() : state_(EVP_MD_CTX_new()) { restart(); }

void Sha256::restart() { is_sound_ = state_ && EVP_DigestInit_ex(state_.get(), EVP_sha256(), nullptr) == 1; }

void Sha256::add(std::string_view bytes) { is_sound_ = is_sound_ && EVP_DigestUpdate(state_.get(), bytes.data(), bytes.size()) == 1; }

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  const bool is_computed = is_sound_ && EVP_DigestFinal_ex(state_.get(), digest.data(), &size) == 1;
  restart();
  return is_computed ? std::string(digest.begin(), digest.begin() + size) : std::string();
}

std::string hexadecimal(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char byte : bytes) {
    const auto value = static_cast<unsigned char>(byte);
    text += kDigits[value >> 4U];
    text += kDigits[value & 15U];
  }
  return text;
}

}  // namespace dts::fleet::s3
