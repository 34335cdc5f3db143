// SPDX-License-Identifier: Apache-2.0
#include "session/label_rule.h"

#include <string_view>
#include <vector>

#include "core/utf8.h"

namespace dts::session {
namespace {

/// Returns the sentences of a text: each ends with '.', '!' or '?' before a space.
std::vector<std::string_view> sentences_of(std::string_view text) {
  std::vector<std::string_view> sentences;
  std::size_t begin = 0;
  for (std::size_t at = 1; at + 1 < text.size(); ++at) {
    if (text[at] != ' ' || std::string_view(".!?").find(text[at - 1]) == std::string_view::npos) continue;
    sentences.push_back(text.substr(begin, at - begin));
    begin = at + 1;
  }
  sentences.push_back(text.substr(begin));
  return sentences;
}

}  // namespace

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

core::Status check_sentences(const LabelRule& rule, const std::string& what, const std::string& text, std::size_t longest) {
  DTS_TRY(check_plain_text(what, text, longest));
  for (const std::string_view sentence : sentences_of(text)) {
    DTS_TRY(check_label(rule, what, std::string(sentence), longest));
  }
  return {};
}

core::Status check_subject(const LabelRule& rule, const std::string& subject) {
  if (subject.empty() || !rule.subject_pattern || rule.subject_pattern->matches(subject)) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "the subject ID does not follow this clinic's rule for subject IDs",
                    rule.subject_hint);
}

}  // namespace dts::session
