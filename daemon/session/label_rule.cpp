// SPDX-License-Identifier: Apache-2.0
#include "session/label_rule.h"

#include "core/utf8.h"

namespace dts::session {
core::Status check_plain_text(const std::string& what, const std::string& text, std::size_t longest) {
  if (text.size() > longest) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "the " + what + " has " + std::to_string(text.size()) + " bytes, more than " + std::to_string(longest),
                      "write a shorter text");
  }
  if (core::printable(text) == text) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "the " + what + " has a character that is not visible",
                    "write it on one line, without control characters");
}

core::Status check_label(const LabelRule& rule, const std::string& what, const std::string& text, std::size_t longest) {
  DTS_TRY(check_plain_text(what, text, longest));
  if (text.empty() || !rule.pattern || rule.pattern->matches(text)) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "the " + what + " does not follow this clinic's rule for labels", rule.hint);
}

}  // namespace dts::session
