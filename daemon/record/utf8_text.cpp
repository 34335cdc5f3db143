// SPDX-License-Identifier: Apache-2.0
#include "record/utf8_text.h"

#include <cstddef>
#include <cstdint>

#include "core/utf8.h"

namespace dts::record {
namespace {

bool is_xml_character(std::uint32_t code) noexcept {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return code < 0xD800 || (code > 0xDFFF && code < 0xFFFE) || (code > 0xFFFF && code <= 0x10FFFF);
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const core::Utf8Character first = core::first_character(text);
    const bool may_stay = first.length > 0 && is_xml_character(first.code);
    clean.append(may_stay ? text.substr(0, first.length) : core::kReplacementCharacter);
    text.remove_prefix(may_stay ? first.length : 1);
  }
  return clean;
}

}  // namespace dts::record
