// SPDX-License-Identifier: Apache-2.0
// A clinic's rule for labels (the first line) and a label (the rest). A rule that is accepted decides about every text in bounded time.
#include "core/text_pattern.h"
#include "core/utf8.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::label_pattern {

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::size_t kLongestLabel = 200;
  const std::string text = text_of(bytes, size);
  const std::size_t end = std::min(text.find('\n'), text.size());
  const auto pattern = core::TextPattern::compile(text.substr(0, end));
  if (!pattern) return promise(!pattern.error().what.empty(), "a mistake has a place");
  const std::string label = text.substr(std::min(end + 1, text.size()), kLongestLabel);
  const bool is_match = pattern->matches(label);
  promise(!is_match || core::is_utf8(label), "only text matches");
  promise(pattern->matches(label) == is_match, "it decides the same each time");
}

}  // namespace dts::fuzz::label_pattern

DTS_FUZZ_TARGET(label_pattern)
