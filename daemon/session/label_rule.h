// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/text_pattern.h"

namespace dts::session {

/// What a clinic allows in subject IDs, labels, markers, notes and reasons. People type all of them, and they go into recordings, reports
/// or exports.
struct LabelRule {
  std::optional<core::TextPattern> pattern{};          ///< Of labels, markers, notes and reasons. Absent: every text.
  std::string hint{};                                  ///< For people who type a text: what is allowed, and why.
  std::optional<core::TextPattern> subject_pattern{};  ///< Of subject IDs. Absent: every ID.
  std::string subject_hint{};                          ///< For people who type an ID: its form, with an example.
};

/// The rule of a clinic that has set none, for every script. The first word may be anything; a later word begins with another character
/// than a capital letter, or is a short code of capitals. So "eyes closed", "Baseline 2" and "T1 OP" are allowed, and "Anna Schmidt, born
/// 1950" is not. No rule can know all names, and in scripts without capitals it knows none: it stops the usual sentence with a name.
inline constexpr std::string_view kDefaultLabelPattern = R"([^=+@<>\-\p{Z}][^<>\p{Z}]*( ([^<>\p{Lu}\p{Z}][^<>\p{Z}]*|[\p{Lu}0-9]{1,5}))*)";
inline constexpr std::string_view kDefaultLabelHint =
    "Use words and numbers such as \"eyes closed\" or \"Baseline 2\". Labels go into files: do not enter names or birth dates";
/// The hint of a clinic that has set a rule and no hint.
inline constexpr std::string_view kGeneralLabelHint =
    "Ask your engineer for the rule: label_pattern in dtsd.toml. Labels go into files: do not enter names or birth dates";

/// The hint of a clinic that has set a rule for subject IDs and no hint.
inline constexpr std::string_view kGeneralSubjectHint =
    "Ask your engineer for the rule: subject_pattern in dtsd.toml. Use the clinic's subject ID, never a name";

inline constexpr std::size_t kLongestLabel = 200;
/// Fails with InvalidArgument if the text does not follow the rule, has more than `longest` bytes, or fails `check_plain_text`. The message
/// does not repeat the text, which may be a name. `what`: "label", "marker".
[[nodiscard]] core::Status check_label(const LabelRule& rule, const std::string& what, const std::string& text,
                                       std::size_t longest = kLongestLabel);

/// The same for notes and reasons, which may have several sentences: each must follow the rule. `what`: "text of the notes", "reason".
[[nodiscard]] core::Status check_sentences(const LabelRule& rule, const std::string& what, const std::string& text,
                                           std::size_t longest = kLongestLabel);

/// Fails with InvalidArgument if a subject ID does not follow the rule; an empty one, which means no subject, does. The message does not
/// repeat the ID, which may be a name.
[[nodiscard]] core::Status check_subject(const LabelRule& rule, const std::string& subject);

/// Fails with InvalidArgument if a text has more than `longest` bytes, is not UTF-8, or has control characters or characters that change
/// the direction of text: such a text can look like another one. `what`: "reason", "notes".
[[nodiscard]] core::Status check_plain_text(const std::string& what, const std::string& text, std::size_t longest);

}  // namespace dts::session
