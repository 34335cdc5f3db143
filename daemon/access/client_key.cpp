// SPDX-License-Identifier: Apache-2.0
#include "access/client_key.h"

#include <zmq.h>

#include <array>
#include <cstdint>
#include <utility>

namespace dts::access {
namespace {

constexpr std::array<std::pair<std::string_view, v1::Role>, 3> kRoles{
    {{"viewer", v1::ROLE_VIEWER}, {"operator", v1::ROLE_OPERATOR}, {"engineer", v1::ROLE_ENGINEER}}};

}  // namespace

bool is_key_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kLongestKeyName && name != "local" &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789._-") == std::string_view::npos;
}

bool is_public_key(std::string_view text) {
  if (text.size() != kKeyCharacters || text.find('\0') != std::string_view::npos) return false;
  std::array<std::uint8_t, 32> bytes{};
  return zmq_z85_decode(bytes.data(), std::string(text).c_str()) != nullptr;
}

std::string_view role_word(v1::Role role) noexcept {
  for (const auto& [word, known] : kRoles) {
    if (known == role) return word;
  }
  return "none";
}

std::optional<v1::Role> role_of_word(std::string_view word) noexcept {
  for (const auto& [known, role] : kRoles) {
    if (known == word) return role;
  }
  return std::nullopt;
}

}  // namespace dts::access
