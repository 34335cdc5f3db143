// SPDX-License-Identifier: Apache-2.0
// How the supervisor corrects, deletes and erases what was recorded.
#include <algorithm>
#include <utility>

#include "session/supervisor.h"

namespace dts::session {

core::Result<record::SessionRow> Supervisor::correct_session(const CorrectionRequest& request, const std::string& who) {
  DTS_TRY_ASSIGN(const auto session, services_.recordings.closed_session(request.session_id));
  if (session.is_deleted) {
    return core::fail(core::ErrorCode::WrongState, "session " + session.id + " is deleted",
                      "restore it first: dtsctl session restore " + session.id);
  }
  DTS_TRY_ASSIGN(auto corrections, corrections_for(session, request, services_.label_rule));
  return corrected_session(session, std::move(corrections), who);
}

core::Result<record::SessionRow> Supervisor::delete_session(const std::string& id, const std::string& reason, bool is_restore,
                                                            const std::string& who) {
  DTS_TRY_ASSIGN(const auto session, services_.recordings.closed_session(id));
  if (!is_restore || !reason.empty()) DTS_TRY(check_reason(reason, services_.label_rule));
  if (session.is_deleted != is_restore) {
    return core::fail(core::ErrorCode::WrongState, "session " + session.id + (is_restore ? " is not deleted" : " is deleted already"),
                      is_restore ? "see dtsctl session list --deleted" : "restore it: dtsctl session restore " + session.id);
  }
  record::Correction correction{.who = {},
                                .field = record::CorrectedField::Deleted,
                                .old_value = is_restore ? "yes" : "no",
                                .new_value = is_restore ? "no" : "yes",
                                .reason = reason};
  return corrected_session(session, {std::move(correction)}, who);
}

core::Result<record::SessionRow> Supervisor::corrected_session(const record::SessionRow& session,
                                                               std::vector<record::Correction> corrections, const std::string& who) {
  for (record::Correction& correction : corrections) correction.who = who;
  DTS_TRY(services_.recordings.correct(session, std::move(corrections)));
  DTS_TRY_ASSIGN(auto changed, services_.recordings.catalogue().session(session.id));
  if (changed.subject != session.subject) forget_empty_notes(session.subject);
  find_newest_session();                      // perhaps a session with a wrong date was deleted
  for (auto& [rig_name, entry] : entries_) {  // its rigs show it until their next session
    entry.session.revise(changed, moment(entry));
    collect_session_changes(entry);
  }
  return changed;
}

core::Status Supervisor::edit_subject(const SubjectEdit& edit, const std::string& who) {
  Recordings& recordings = services_.recordings;
  DTS_TRY_ASSIGN(auto notes, recordings.subject_notes(edit.subject));
  DTS_TRY_ASSIGN(const auto found, recordings.catalogue().subjects({.subject = edit.subject, .limit = 1}));
  DTS_TRY_ASSIGN(const auto noted, recordings.subjects_with_notes());
  if (edit.subject.empty() || (found.empty() && !std::ranges::binary_search(noted, edit.subject))) {
    return core::fail(core::ErrorCode::NotFound, "no session has this subject ID", "see dtsctl subject list");
  }
  const EditAuthor author{.who = who, .utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns()};
  DTS_TRY_ASSIGN(const auto changed, edited(std::move(notes), edit, author, services_.protocols, services_.label_rule));
  DTS_TRY(recordings.keep_notes(changed));
  forget_empty_notes(edit.subject);
  return {};
}

void Supervisor::forget_empty_notes(const std::string& subject) {
  if (subject.empty()) return;
  Recordings& recordings = services_.recordings;
  const auto notes = recordings.subject_notes(subject);
  const auto sessions = recordings.catalogue().sessions({.subject = subject, .limit = 1, .shown = record::Shown::Both});
  // A file that cannot be read or removed stays, as does its subject in the list: it can be erased.
  if (notes && notes->is_empty() && sessions && sessions->empty()) static_cast<void>(recordings.keep_notes({.subject = subject}));
}

core::Status Supervisor::erase_subject(const std::string& subject, const std::string& who) {
  for (auto& [rig_name, entry] : entries_) {
    if (!entry.session.is_under_way() || entry.session.view(clock_.now_ns()).request.subject != subject) continue;
    return core::fail(core::ErrorCode::WrongState, "a session of this subject is running on rig '" + rig_name + "'",
                      "stop it first: dtsctl session stop --rig " + rig_name);
  }
  DTS_TRY(services_.recordings.begin_erasure(subject, who));
  find_newest_session();                      // the warning about the clock must not name an erased session
  for (auto& [rig_name, entry] : entries_) {  // the status shows the last session of a rig
    entry.session.forget(subject, moment(entry));
    collect_session_changes(entry);
  }
  return {};
}

}  // namespace dts::session
