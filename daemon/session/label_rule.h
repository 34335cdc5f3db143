// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/text_pattern.h"

namespace dts::session {

/// What a clinic allows in labels and markers. Both are free text of people, and go into recordings, reports and exports.
struct LabelRule {
  std::optional<core::TextPattern> pattern{};  ///< Absent: every text.
  std::string hint{};                          ///< For people who type a text: what is allowed, and why.
};

/// The rule of a clinic that has set none. The first word may be anything; a later word begins with a small letter or a digit, or is a
/// short code of capitals. Letters are Latin, Greek and Cyrillic ones. So "eyes closed", "Baseline 2" and "T1 OP" are allowed, and "Anna
/// Schmidt, born 1950" is not. No rule can know all names: it stops the usual sentence with a name.
inline constexpr std::string_view kDefaultLabelPattern =
    "[A-Za-z\u00C0-\u024F\u0370-\u04FF0-9(][A-Za-z\u00C0-\u024F\u0370-\u04FF0-9._+%/:,;!?()\"#\\-]*"
    "( ([a-z\u00DF-\u00FF\u03AC-\u03CE\u0430-\u045F"
    "\u0101\u0103\u0105\u0107\u0109\u010B\u010D\u010F\u0111\u0113\u0115\u0117\u0119\u011B\u011D\u011F"
    "\u0121\u0123\u0125\u0127\u0129\u012B\u012D\u012F\u0131\u0133\u0135\u0137\u013A\u013C\u013E\u0140"
    "\u0142\u0144\u0146\u0148\u014B\u014D\u014F\u0151\u0153\u0155\u0157\u0159\u015B\u015D\u015F\u0161"
    "\u0163\u0165\u0167\u0169\u016B\u016D\u016F\u0171\u0173\u0175\u0177\u017A\u017C\u017E"
    "0-9._+%/:,;!?()\"#\\-][A-Za-z\u00C0-\u024F\u0370-\u04FF0-9._+%/:,;!?()\"#\\-]*|[A-Z0-9]{1,5}))*";
inline constexpr std::string_view kDefaultLabelHint =
    "Use words and numbers such as \"eyes closed\" or \"Baseline 2\". Labels go into files: do not enter names or birth dates";
/// The hint of a clinic that has set a rule and no hint.
inline constexpr std::string_view kGeneralLabelHint =
    "Ask your engineer for the rule: label_pattern in dtsd.toml. Labels go into files: do not enter names or birth dates";

/// Fails with InvalidArgument if the text does not follow the rule, has more than 200 bytes, or fails `check_plain_text`. The message does
/// not repeat the text, which may be a name. `what`: "label", "marker".
[[nodiscard]] core::Status check_label(const LabelRule& rule, const std::string& what, const std::string& text);

/// Fails with InvalidArgument if a text has more than `longest` bytes, is not UTF-8, or has control characters or characters that change
/// the direction of text: such a text can look like another one. `what`: "reason", "notes".
[[nodiscard]] core::Status check_plain_text(const std::string& what, const std::string& text, std::size_t longest);

}  // namespace dts::session
