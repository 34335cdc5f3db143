// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace dts::c3d {

/// How a file stores numbers. Whole numbers of DEC are like those of Intel.
enum class Encoding : std::uint8_t { Intel = 84, Dec = 85, Sgi = 86 };

/// Reads two bytes of `at`, which has at least two.
[[nodiscard]] constexpr std::uint16_t unsigned_word(Encoding encoding, const char* at) noexcept {
  const auto first = static_cast<unsigned char>(at[0]);
  const auto second = static_cast<unsigned char>(at[1]);
  return encoding == Encoding::Sgi ? static_cast<std::uint16_t>(first << 8U | second) : static_cast<std::uint16_t>(second << 8U | first);
}

[[nodiscard]] constexpr std::int16_t signed_word(Encoding encoding, const char* at) noexcept {
  return static_cast<std::int16_t>(unsigned_word(encoding, at));
}

/// Reads four bytes of `at`, which has at least four. A real number of DEC (VAX F) has its words exchanged and another exponent: it is a
/// quarter of what IEEE would read, and knows no infinity.
[[nodiscard]] constexpr double real(Encoding encoding, const char* at) noexcept {
  const std::uint32_t first = unsigned_word(encoding, at);
  const std::uint32_t second = unsigned_word(encoding, at + 2);
  if (encoding == Encoding::Intel) return static_cast<double>(std::bit_cast<float>(second << 16U | first));
  const std::uint32_t bits = first << 16U | second;
  if (encoding == Encoding::Sgi) return static_cast<double>(std::bit_cast<float>(bits));
  const std::uint64_t exponent = bits >> 23U & 0xFFU;
  if (exponent == 0) return 0.0;
  constexpr std::uint64_t kBiasOfDouble = 1023;
  constexpr std::uint64_t kBiasOfDec = 129;
  const std::uint64_t sign = bits >> 31U;
  const std::uint64_t fraction = bits & 0x7FFFFFU;
  return std::bit_cast<double>(sign << 63U | (exponent + kBiasOfDouble - kBiasOfDec) << 52U | fraction << 29U);
}

}  // namespace dts::c3d
