// SPDX-License-Identifier: Apache-2.0
// The commands of CommandHandler that correct, delete and erase what was recorded.
#include <algorithm>

#include "ipc/command_handler.h"
#include "ipc/encode_session.h"
#include "record/utf8_text.h"
#include "session/figure.h"

namespace dts::ipc {
namespace {

using core::ErrorCode;

// These keep an answer below a few MB. Its time on the control thread grows with the number of sessions, because the catalogue must look at
// all of them. The catalogue reads details only for what is listed.
constexpr std::size_t kMostSessions = 1000;
constexpr std::size_t kMostWithResults = 200;
constexpr std::size_t kMostSubjects = 10'000;
constexpr const char* kBackups =
    "Backups and copies still have this subject. Replace each backup by a new one, or note the subject ID in the list of erasures that "
    "your clinic keeps apart from this machine, and erase the subject again after you restore a backup. Reports, exports and copies that "
    "people saved elsewhere must be deleted by them. A gateway that does not run drops its cached reports and exports when it starts.";

}  // namespace

dts::v1::Response CommandHandler::correct_session(const dts::v1::CorrectSessionRequest& request, const std::string& author) {
  const auto given = [](bool is_given, const std::string& text) { return is_given ? std::optional(text) : std::nullopt; };
  const auto session = supervisor_.correct_session({.session_id = request.session_id(),
                                                    .subject = given(request.has_subject(), request.subject()),
                                                    .label = given(request.has_label(), request.label()),
                                                    .notes = given(request.has_notes(), request.notes()),
                                                    .trial = request.trial(),
                                                    .attempt = request.attempt(),
                                                    .part = request.part(),
                                                    .outcome = request.outcome(),
                                                    .marker = request.marker(),
                                                    .marker_text = given(request.has_marker_text(), request.marker_text()),
                                                    .reason = request.reason()},
                                                   author);
  return session ? session_answer(*session) : error_response(session.error());
}

dts::v1::Response CommandHandler::delete_session(const dts::v1::DeleteSessionRequest& request, const std::string& author) {
  const auto session = supervisor_.delete_session(request.session_id(), request.reason(), request.is_restore(), author);
  return session ? session_answer(*session) : error_response(session.error());
}

dts::v1::Response CommandHandler::list_subjects() {
  const record::Catalogue& catalogue = supervisor_.recordings().catalogue();
  const auto subjects = catalogue.subjects({.limit = kMostSubjects});
  if (!subjects) return error_response(subjects.error());
  const auto all = subjects->size() < kMostSubjects ? subjects->size() : catalogue.count_subjects();
  if (!all) return error_response(all.error());
  const auto noted = supervisor_.recordings().subjects_with_notes();
  if (!noted) return error_response(noted.error());
  dts::v1::Response response;
  auto& out = *response.mutable_subjects();
  auto listed = *subjects;
  for (const std::string& id : *noted) {  // a planned subject whose sessions were given another ID is not lost
    const bool is_listed = std::ranges::binary_search(*subjects, id, {}, &record::SubjectRow::subject);
    if (!is_listed && listed.size() < kMostSubjects && *all == subjects->size()) listed.push_back({.subject = id});
  }
  std::ranges::sort(listed, {}, &record::SubjectRow::subject);
  for (const record::SubjectRow& subject : listed) *out.add_subjects() = subject_info(subject);
  out.set_more_subjects(static_cast<std::uint32_t>(*all - subjects->size()));
  return response;
}

dts::v1::Response CommandHandler::show_subject(const dts::v1::ShowSubjectRequest& request) {
  session::Recordings& recordings = supervisor_.recordings();
  const auto found = recordings.catalogue().subjects({.subject = request.subject(), .limit = 1});
  if (!found) return error_response(found.error());
  const auto mentioning = recordings.sessions_mentioning(request.subject(), kMostSessions);
  if (!mentioning) return error_response(mentioning.error());
  const auto notes = recordings.subject_notes(request.subject());
  if (!notes) return error_response(notes.error());
  // A file without entries, or one that a crash left unfinished, is listed and can be erased, so it is shown too.
  const auto noted = recordings.subjects_with_notes();
  if (!noted) return error_response(noted.error());
  const bool has_file = std::ranges::binary_search(*noted, request.subject());
  if (request.subject().empty() || (found->empty() && mentioning->sessions.empty() && !has_file)) {
    return error_response({ErrorCode::NotFound, "no session has this subject ID", "see dtsctl subject list"});
  }
  const auto rows = recordings.catalogue().sessions({.subject = request.subject(), .limit = kMostSessions, .shown = record::Shown::Both});
  if (!rows) return error_response(rows.error());
  dts::v1::Response response;
  auto& out = *response.mutable_subject();
  *out.mutable_about() = subject_info(found->empty() ? record::SubjectRow{.subject = request.subject()} : found->front());
  std::vector<record::SessionRow> present;
  for (const record::SessionRow& row : *rows) present.push_back(recordings.corrected(row));
  add_notes(
      *notes, present, [&](const record::SessionRow& row) { return supervisor_.planned_trials(row); }, out);
  if (request.with_results() && present.size() > kMostWithResults) present.resize(kMostWithResults);
  for (const record::SessionRow& row : present) {
    auto& session = *out.add_sessions();
    session = listed_session(row, supervisor_.planned_trials(row));
    if (!request.with_results()) continue;
    const auto results = recordings.catalogue().results(row.id);
    if (!results) return error_response(results.error());
    for (const record::ResultRow& result : *results) *session.add_results() = session_result(result);
    // Which arm reached: visits with the other one are not compared.
    const auto is_of_reaches = [](const record::ResultRow& result) { return session::without_part_suffix(result.name).first == "targets"; };
    if (std::ranges::any_of(*results, is_of_reaches)) add_fields(row, session);
  }
  for (const std::string& id : mentioning->sessions) out.add_mentioning_sessions(id);
  out.set_unsearched_sessions(static_cast<std::uint32_t>(mentioning->unsearched));
  return response;
}

dts::v1::Response CommandHandler::edit_subject(const dts::v1::EditSubjectRequest& request, const std::string& author) {
  session::SubjectEdit edit{.subject = request.subject()};
  switch (request.change_case()) {
    case dts::v1::EditSubjectRequest::kAddNote: edit.change = session::AddNote{request.add_note()}; break;
    case dts::v1::EditSubjectRequest::kRemoveNote: edit.change = session::RemoveNote{request.remove_note()}; break;
    case dts::v1::EditSubjectRequest::kAddPlan:
      edit.change = session::AddPlan{.protocol = request.add_plan().protocol(), .due_date = request.add_plan().due_date()};
      break;
    case dts::v1::EditSubjectRequest::kRemovePlan: edit.change = session::RemovePlan{request.remove_plan()}; break;
    case dts::v1::EditSubjectRequest::CHANGE_NOT_SET: break;
  }
  if (auto changed = supervisor_.edit_subject(edit, author); !changed) return error_response(changed.error());
  dts::v1::ShowSubjectRequest shown;
  shown.set_subject(request.subject());
  dts::v1::Response response = show_subject(shown);
  // The last entry of a subject without sessions was removed: nothing has its ID any more.
  if (response.has_error() && response.error().code() == dts::v1::ERROR_CODE_NOT_FOUND) {
    response.mutable_subject()->mutable_about()->set_subject(request.subject());
  }
  return response;
}

CommandHandler::Answer CommandHandler::erase_subject(const dts::v1::EraseSubjectRequest& request, const std::string& author) {
  if (auto begun = supervisor_.erase_subject(request.subject(), author); !begun) return {error_response(begun.error())};
  return {{}, PendingErasure{}};
}

std::optional<dts::v1::Response> CommandHandler::finish_erasure() {
  const auto erased = supervisor_.recordings().take_erased();
  if (!erased) return std::nullopt;
  if (!*erased) return error_response(erased->error());
  dts::v1::Response response;
  auto& out = *response.mutable_erased();
  out.set_sessions((*erased)->sessions);
  out.set_files((*erased)->files);
  out.set_bytes((*erased)->bytes);
  out.set_mentions((*erased)->mentions);
  for (const std::string& left : (*erased)->left) out.add_left(record::clean_text(left));
  out.set_backups(kBackups);
  return response;
}

}  // namespace dts::ipc
