// SPDX-License-Identifier: Apache-2.0
// The commands of CommandHandler on sessions, trials, protocols and the catalogue.

#include <algorithm>

#include "access/client_key.h"
#include "ipc/command_handler.h"
#include "ipc/encode_session.h"
#include "record/utf8_text.h"

namespace dts::ipc {
namespace {

using core::ErrorCode;

constexpr std::uint32_t kDefaultLimit = 100;
constexpr std::uint32_t kLargestLimit = 1000;  // keeps an answer below a few MB
constexpr std::size_t kMostFields = 64;

std::size_t limit_of(std::uint32_t asked) { return std::clamp(asked == 0 ? kDefaultLimit : asked, 1U, kLargestLimit); }

}  // namespace

dts::v1::Response CommandHandler::start_session(const dts::v1::StartSessionRequest& request) {
  session::SessionRequest asked{.protocol = request.protocol(),
                                .subject = request.subject(),
                                .label = request.label(),
                                .duration_s = request.duration_s(),
                                .settle_s = request.settle_s()};
  if (static_cast<std::size_t>(request.fields_size()) > kMostFields) {
    return error_response({ErrorCode::LimitExceeded, "a session has at most 64 fields", "see dtsctl protocol show " + asked.protocol});
  }
  for (const auto& [field, value] : request.fields()) asked.fields.emplace_back(field, value);
  std::ranges::sort(asked.fields);  // a protobuf map has no order
  const auto started = supervisor_.start_session(request.rig(), asked, {request.companions().begin(), request.companions().end()});
  if (!started) return error_response(started.error());
  dts::v1::Response response;
  *response.mutable_session() = session_info(request.rig(), *started);
  return response;
}

dts::v1::Response CommandHandler::resume_session(const dts::v1::ResumeSessionRequest& request) {
  const auto resumed = supervisor_.resume_session(request.session_id());
  if (!resumed) return error_response(resumed.error());
  dts::v1::Response response;
  *response.mutable_session() = session_info(resumed->first, resumed->second);
  return response;
}

CommandHandler::Answer CommandHandler::stop_session(const dts::v1::StopSessionRequest& request) {
  const auto good = session::check_sentences(supervisor_.label_rule(), "reason", request.reason());  // a wrong one must not delay the stop
  const auto stopped = supervisor_.stop_session(request.rig(), request.is_abort(), good ? request.reason() : "");
  if (!stopped) return {error_response(stopped.error())};
  PendingStop pending{.rig = stopped->first, .session_id = stopped->second.id};
  if (!good) {
    pending.problem = good.error().what + ", so it is left out; enter it as notes: dtsctl session edit " + pending.session_id +
                      " --notes TEXT --reason TEXT";
  }
  if (auto response = finish_stop(pending)) return {std::move(*response)};
  return {{}, pending};
}

std::optional<dts::v1::Response> CommandHandler::finish_stop(const PendingStop& pending) {
  const auto view = supervisor_.session(pending.rig);
  if (!view) return error_response(view.error());
  if (view->id == pending.session_id && view->state == session::SessionState::Stopping) return std::nullopt;
  dts::v1::Response response;
  *response.mutable_session() = session_info(pending.rig, *view);
  if (!pending.problem.empty()) {
    std::string& message = *response.mutable_session()->mutable_message();
    message += (message.empty() ? "" : "; ") + pending.problem;
  }
  session::Recordings& recordings = supervisor_.recordings();
  *response.mutable_session()->mutable_recording() = recording_status(recordings.view(pending.rig), recordings.part(pending.rig));
  return response;
}

dts::v1::Response CommandHandler::trial(const dts::v1::TrialRequest& request) {
  session::TrialAction action{};
  switch (request.action()) {
    case dts::v1::TRIAL_ACTION_NEXT: action = session::TrialAction::Next; break;
    case dts::v1::TRIAL_ACTION_REDO: action = session::TrialAction::Redo; break;
    case dts::v1::TRIAL_ACTION_REJECT: action = session::TrialAction::Reject; break;
    case dts::v1::TRIAL_ACTION_UNDO: action = session::TrialAction::Undo; break;
    default: return error_response({ErrorCode::InvalidArgument, "unknown action on a trial", "use next, redo, reject or undo"});
  }
  const auto trial = supervisor_.trial(request.rig(), action);
  if (!trial) return error_response(trial.error());
  dts::v1::Response response;
  *response.mutable_trial() = trial_status(*trial);
  return response;
}

dts::v1::Response CommandHandler::list_protocols() {
  dts::v1::Response response;
  auto& out = *response.mutable_protocols();
  for (const session::Protocol& protocol : supervisor_.protocols()) *out.add_protocols() = protocol_info(protocol);
  const session::LabelRule& rule = supervisor_.label_rule();
  out.set_label_hint(rule.hint);
  if (rule.pattern) out.set_label_pattern(rule.pattern->pattern());
  return response;
}

dts::v1::Response CommandHandler::list_sessions(const dts::v1::ListSessionsRequest& request) {
  session::Recordings& recordings = supervisor_.recordings();
  const auto rows = recordings.catalogue().sessions({.rig = request.rig(),
                                                     .subject = request.subject(),
                                                     .protocol = request.protocol(),
                                                     .limit = limit_of(request.limit()),
                                                     .shown = request.deleted() ? record::Shown::Deleted : record::Shown::Kept});
  if (!rows) return error_response(rows.error());
  dts::v1::Response response;
  auto& out = *response.mutable_sessions();
  for (const record::SessionRow& row : *rows)
    *out.add_sessions() = listed_session(recordings.corrected(row), supervisor_.planned_trials(row));
  return response;
}

dts::v1::Response CommandHandler::show_session(const dts::v1::ShowSessionRequest& request) {
  session::Recordings& recordings = supervisor_.recordings();
  const auto row = recordings.catalogue().session(request.session_id());
  return row ? session_answer(*row) : error_response(row.error());
}

dts::v1::Response CommandHandler::session_answer(const record::SessionRow& row) {
  session::Recordings& recordings = supervisor_.recordings();
  const auto results = recordings.catalogue().results(row.id);
  if (!results) return error_response(results.error());
  dts::v1::Response response;
  *response.mutable_session_record() = session_record(recordings.corrected(row), supervisor_.planned_trials(row));
  add_fields(row, *response.mutable_session_record());
  for (const record::ResultRow& result : *results) *response.mutable_session_record()->add_results() = session_result(result);
  return response;
}

dts::v1::Response CommandHandler::audit(const dts::v1::GetAuditRequest& request) {
  session::Recordings& recordings = supervisor_.recordings();
  const auto entries = recordings.catalogue().audit(limit_of(request.limit()));
  if (!entries) return error_response(entries.error());
  dts::v1::Response response;
  auto& out = *response.mutable_audit();
  for (const record::AuditEntry& entry : *entries) *out.add_entries() = audit_entry(entry);
  const auto verified = recordings.catalogue().verify_audit();
  if (verified) {
    out.set_verified_entries(*verified);
  } else {
    out.set_problem(core::to_string(verified.error()));
  }
  if (const std::string& owed = recordings.audit_problem(); !owed.empty() && verified) {
    out.set_problem("the newest entries are not written yet: " + owed);
  }
  return response;
}

dts::v1::Response CommandHandler::note_login(const dts::v1::NoteLoginRequest& request) {
  constexpr std::size_t kLongestAddress = 64;
  constexpr const char* kAddressLetters = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.:%_-";
  const std::string& address = request.address();
  const bool is_address =
      !address.empty() && address.size() <= kLongestAddress && address.find_first_not_of(kAddressLetters) == std::string::npos;
  if (!is_address || !(request.user().empty() || access::is_key_name(request.user()))) {
    return error_response({ErrorCode::InvalidArgument, "the note of a login has no user or no address", ""});
  }
  dts::v1::Response response;
  response.mutable_note_login();
  return response;
}

}  // namespace dts::ipc
