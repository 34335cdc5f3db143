// SPDX-License-Identifier: Apache-2.0
#include "core/number_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace dts::core {

std::string number_text(double value) {
  const double size = std::abs(value);
  const bool is_plain = size == 0.0 || (size >= 1e-5 && size < 1e9);
  std::array<char, 32> digits{};
  const auto format = is_plain ? std::chars_format::fixed : std::chars_format::general;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value, format).ptr};
}

}  // namespace dts::core
