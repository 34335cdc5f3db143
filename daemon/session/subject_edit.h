// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "core/result.h"
#include "record/catalogue/subject_notes.h"
#include "session/label_rule.h"
#include "session/protocol.h"

namespace dts::session {

struct AddNote {
  std::string text;
};
struct RemoveNote {
  std::uint32_t number = 0;
};
struct AddPlan {
  std::string protocol;
  std::string due_date;  ///< "2026-12-31"; empty: none.
};
struct RemovePlan {
  std::uint32_t number = 0;
};

/// What an operator wants to change in the notes or the plan of a subject.
struct SubjectEdit {
  std::string subject;
  std::variant<std::monostate, AddNote, RemoveNote, AddPlan, RemovePlan> change{};
};

/// Who changes it, and when.
struct EditAuthor {
  std::string who;
  std::int64_t utc_ns = 0;
};

/// Returns the notes with the change. Fails with InvalidArgument for a text or a date that is not allowed or if nothing would change, with
/// NotFound for an unknown number or protocol, and with LimitExceeded if there are too many notes or planned sessions.
[[nodiscard]] core::Result<record::SubjectNotes> edited(record::SubjectNotes notes, const SubjectEdit& edit, const EditAuthor& author,
                                                        std::span<const Protocol> protocols, const LabelRule& rule);

}  // namespace dts::session
