// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::record {

/// A note about a subject, apart from its sessions.
struct SubjectNote {
  std::uint32_t number = 1;
  std::int64_t utc_ns = 0;
  std::string who;  ///< As in an audit entry.
  std::string text;

  friend bool operator==(const SubjectNote&, const SubjectNote&) = default;
};

/// A session that is planned for a subject.
struct PlannedSession {
  std::uint32_t number = 1;
  std::int64_t utc_ns = 0;  ///< When it was planned.
  std::string who;
  std::string protocol;
  std::string due_date;  ///< "2026-12-31"; empty: none.

  friend bool operator==(const PlannedSession&, const PlannedSession&) = default;
};

/// What people wrote about a subject: notes and plan, each in the order in which they were added. They are in one file for each subject,
/// "subjects/ID.json" in the folder of the recordings, so that they survive the loss of the catalogue and are in the same backup. No
/// catalogue has a copy.
struct SubjectNotes {
  std::string subject;
  std::uint32_t next_number = 1;  ///< Numbers of removed entries are not used again.
  std::vector<SubjectNote> notes{};
  std::vector<PlannedSession> plan{};

  [[nodiscard]] bool is_empty() const noexcept { return notes.empty() && plan.empty(); }
  friend bool operator==(const SubjectNotes&, const SubjectNotes&) = default;
};

inline constexpr std::size_t kMostSubjectNotes = 500;  ///< Of one subject.
inline constexpr std::size_t kMostPlanned = 100;

/// Returns true for a date such as "2026-12-31".
[[nodiscard]] bool is_date(const std::string& text);

/// Returns what is in the subject's file; nothing without a file. Fails with DataDamaged, naming the file, if it has something else.
[[nodiscard]] core::Result<SubjectNotes> read_subject_notes(const std::string& recordings, const std::string& subject);
/// Replaces the file as a whole; without entries it still has the next number. Makes no file for notes that never had an entry. The file is
/// on the disk when this returns. `subject` must be an ID.
[[nodiscard]] core::Status write_subject_notes(const std::string& recordings, const SubjectNotes& notes);
/// Removes the file, if there is one, and what a crash left of it. Returns the number of removed files.
[[nodiscard]] core::Result<std::uint32_t> remove_subject_notes(const std::string& recordings, const std::string& subject);
/// Returns the IDs of the subjects that have a file, or one that a crash left unfinished; sorted, each once.
[[nodiscard]] core::Result<std::vector<std::string>> subjects_with_notes(const std::string& recordings);
/// Removes mentions of this subject ID from the texts of other subjects' notes. Returns the files that cannot be read and may have some.
[[nodiscard]] core::Result<std::vector<std::string>> remove_mentions_in_notes(const std::string& recordings, const std::string& subject);
/// Returns a message with "ID" instead of the subject IDs in the names of these files. The message must quote them: '/.../P017.json'.
[[nodiscard]] std::string without_subjects(const std::string& recordings, std::string message);

}  // namespace dts::record
