// SPDX-License-Identifier: Apache-2.0
#include "record/utf8_text.h"

#include <cstddef>
#include <cstdint>

namespace dts::record {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

struct Sequence {
  std::size_t length = 0;  ///< 0: not the start of any.
  std::uint32_t first_bits = 0;
  std::uint32_t smallest = 0;  ///< Anything below could have been written shorter, and must be.
};

Sequence sequence_of(unsigned char first) noexcept {
  if (first < 0x80U) return {1, first, 0};
  if ((first & 0xE0U) == 0xC0U) return {2, first & 0x1FU, 0x80};
  if ((first & 0xF0U) == 0xE0U) return {3, first & 0x0FU, 0x800};
  if ((first & 0xF8U) == 0xF0U) return {4, first & 0x07U, 0x10000};
  return {};
}

bool is_xml_character(std::uint32_t code) noexcept {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return code < 0xD800 || (code > 0xDFFF && code < 0xFFFE) || (code > 0xFFFF && code <= 0x10FFFF);
}

/// Bytes of the character that `text` starts with; 0 when it is none that may stay.
std::size_t good_length(std::string_view text) noexcept {
  const Sequence sequence = sequence_of(static_cast<unsigned char>(text.front()));
  if (sequence.length == 0 || sequence.length > text.size()) return 0;
  std::uint32_t code = sequence.first_bits;
  for (const char byte : text.substr(1, sequence.length - 1)) {
    const auto bits = static_cast<unsigned char>(byte);
    if ((bits & 0xC0U) != 0x80U) return 0;
    code = (code << 6U) | (bits & 0x3FU);
  }
  return code >= sequence.smallest && is_xml_character(code) ? sequence.length : 0;
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = good_length(text);
    clean.append(length > 0 ? text.substr(0, length) : kReplacement);
    text.remove_prefix(length > 0 ? length : 1);
  }
  return clean;
}

}  // namespace dts::record
