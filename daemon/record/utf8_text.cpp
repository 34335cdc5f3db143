// SPDX-License-Identifier: Apache-2.0
#include "record/utf8_text.h"

#include <cstdint>

#include "core/utf8.h"

namespace dts::record {
namespace {

bool is_xml_character(std::uint32_t code) noexcept {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return code < 0xD800 || (code > 0xDFFF && code < 0xFFFE) || (code > 0xFFFF && code <= 0x10FFFF);
}

}  // namespace

std::string clean_text(std::string_view text) { return core::allowed_text(text, is_xml_character, core::kReplacementCharacter); }

}  // namespace dts::record
