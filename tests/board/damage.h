// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>

namespace dts::test {

/// What a bad line does to bytes, each with this probability per byte.
struct Damage {
  double flip = 0.0;  ///< One bit is wrong.
  double drop = 0.0;
  double doubled = 0.0;
  std::uint64_t count = 0;  ///< Damaged bytes so far.
  std::mt19937 random{1};

  /// Damages the first `length` bytes of `buffer`, which has room for twice as many. Returns their new number.
  std::size_t apply(std::span<std::uint8_t> buffer, std::size_t length) noexcept {
    if (flip + drop + doubled <= 0.0) return length;
    const auto at_byte = [&](std::size_t at) { return buffer.begin() + static_cast<std::ptrdiff_t>(at); };
    for (std::size_t at = 0; at < length; ++at) {
      const double dice = std::uniform_real_distribution<double>()(random);
      if (dice >= flip + drop + doubled) continue;
      ++count;
      if (dice < flip) {
        buffer[at] = static_cast<std::uint8_t>(buffer[at] ^ (1U << (random() % 8)));
      } else if (dice < flip + drop) {
        std::copy(at_byte(at + 1), at_byte(length), at_byte(at));
        --length;
      } else if (length < buffer.size()) {
        std::copy_backward(at_byte(at), at_byte(length), at_byte(length + 1));
        ++length;
        ++at;
      }
    }
    return length;
  }
};

}  // namespace dts::test
