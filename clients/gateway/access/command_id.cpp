// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/command_id.h"

#include <sodium.h>

#include <array>

namespace dts::gateway {

std::string command_id(const std::string& user, const std::string& browsers_id) {
  const std::string both = user + '\0' + browsers_id;  // no name has a NUL, so the end of the name is unambiguous
  std::array<unsigned char, 32> hash{};
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(both.data()), both.size(), nullptr, 0);
  std::array<char, 2 * hash.size() + 1> text{};
  sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
  return text.data();
}

}  // namespace dts::gateway
