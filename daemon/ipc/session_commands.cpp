// SPDX-License-Identifier: Apache-2.0
#include "ipc/session_commands.h"

#include <algorithm>

#include "access/client_key.h"
#include "ipc/command_handler.h"
#include "ipc/encode_session.h"
#include "record/recording.h"
#include "record/utf8_text.h"

namespace dts::ipc {
namespace {

using core::ErrorCode;

constexpr std::uint32_t kDefaultLimit = 100;
constexpr std::uint32_t kLargestLimit = 1000;  // an answer stays below a few MB
constexpr std::size_t kMostFields = 64;

std::size_t limit_of(std::uint32_t asked) { return std::clamp(asked == 0 ? kDefaultLimit : asked, 1U, kLargestLimit); }

dts::v1::Response nothing_is_recorded() {
  return error_response({ErrorCode::Unsupported, "this daemon records nothing", "it was started without storage"});
}

/// Name and target of a command; an empty name: it changes nothing, and everybody may look.
std::pair<std::string, std::string> named(const dts::v1::Request& request) {
  switch (request.command_case()) {
    case dts::v1::Request::kStartSession: return {"start_session", request.start_session().rig()};
    case dts::v1::Request::kStopSession:
      return {request.stop_session().is_abort() ? "abort_session" : "stop_session", request.stop_session().rig()};
    case dts::v1::Request::kResumeSession: return {"resume_session", request.resume_session().session_id()};
    case dts::v1::Request::kTrial:
      switch (request.trial().action()) {
        case dts::v1::TRIAL_ACTION_NEXT: return {"trial_next", request.trial().rig()};
        case dts::v1::TRIAL_ACTION_REDO: return {"trial_redo", request.trial().rig()};
        case dts::v1::TRIAL_ACTION_REJECT: return {"trial_reject", request.trial().rig()};
        default: return {"trial", request.trial().rig()};
      }
    case dts::v1::Request::kMark: return {"mark", request.mark().rig()};
    case dts::v1::Request::kTare: return {"tare", request.tare().rig()};
    case dts::v1::Request::kTestDevice: return {"device_test", request.test_device().rig()};
    case dts::v1::Request::kGetAudit: return {"audit", ""};
    case dts::v1::Request::kListKeys: return {"key_list", ""};
    case dts::v1::Request::kAddKey: return {"key_new", request.add_key().name()};
    case dts::v1::Request::kRevokeKey: return {"key_revoke", request.revoke_key().name()};
    case dts::v1::Request::kNoteLogin: return {"login", ""};
    default: return {};
  }
}

/// What the protocol asked about the subject: the catalogue does not have it, the recordings do.
void add_fields(const record::SessionRow& row, dts::v1::SessionRecord& out) {
  for (const record::PartRow& part : row.parts) {
    const auto facts = record::read_session_facts(part.file);
    if (!facts) continue;
    for (const auto& [name, value] : facts->fields) (*out.mutable_fields())[record::clean_text(name)] = record::clean_text(value);
    return;
  }
}

}  // namespace

dts::v1::Response SessionCommands::start(const dts::v1::StartSessionRequest& request) {
  session::SessionRequest asked{.protocol = request.protocol().empty() ? "free" : request.protocol(),
                                .subject = request.subject(),
                                .label = request.label(),
                                .duration_s = request.duration_s(),
                                .settle_s = request.settle_s()};
  if (static_cast<std::size_t>(request.fields_size()) > kMostFields) {
    return error_response({ErrorCode::LimitExceeded, "a session has at most 64 fields", "see dtsctl protocol show " + asked.protocol});
  }
  for (const auto& [field, value] : request.fields()) asked.fields.emplace_back(field, value);
  std::ranges::sort(asked.fields);  // a map of the wire has no order
  const auto started = supervisor_.start_session(request.rig(), asked);
  if (!started) return error_response(started.error());
  dts::v1::Response response;
  *response.mutable_session() = session_info(request.rig(), *started);
  return response;
}

dts::v1::Response SessionCommands::resume(const dts::v1::ResumeSessionRequest& request) {
  const auto resumed = supervisor_.resume_session(request.session_id());
  if (!resumed) return error_response(resumed.error());
  dts::v1::Response response;
  *response.mutable_session() = session_info(resumed->first, resumed->second);
  return response;
}

dts::v1::Response SessionCommands::stop(const dts::v1::StopSessionRequest& request, std::optional<PendingStop>& pending) {
  const auto stopped = supervisor_.stop_session(request.rig(), request.is_abort(), request.reason());
  if (!stopped) return error_response(stopped.error());
  const PendingStop asked{.rig = stopped->first, .session_id = stopped->second.id};
  if (auto response = finish(asked)) return *response;
  pending = asked;
  return {};
}

std::optional<dts::v1::Response> SessionCommands::finish(const PendingStop& pending) {
  const auto view = supervisor_.session(pending.rig);
  if (!view) return error_response(view.error());
  if (view->id == pending.session_id && view->state == session::SessionState::Stopping) return std::nullopt;
  dts::v1::Response response;
  *response.mutable_session() = session_info(pending.rig, *view);
  if (session::Recordings* recordings = supervisor_.recordings()) {
    *response.mutable_session()->mutable_recording() = recording_status(recordings->view(pending.rig), recordings->part(pending.rig));
  }
  return response;
}

dts::v1::Response SessionCommands::trial(const dts::v1::TrialRequest& request) {
  session::TrialAction action{};
  switch (request.action()) {
    case dts::v1::TRIAL_ACTION_NEXT: action = session::TrialAction::Next; break;
    case dts::v1::TRIAL_ACTION_REDO: action = session::TrialAction::Redo; break;
    case dts::v1::TRIAL_ACTION_REJECT: action = session::TrialAction::Reject; break;
    default: return error_response({ErrorCode::InvalidArgument, "unknown action on a trial", "next, redo or reject"});
  }
  const auto trial = supervisor_.trial(request.rig(), action);
  if (!trial) return error_response(trial.error());
  dts::v1::Response response;
  *response.mutable_trial() = trial_status(*trial);
  return response;
}

dts::v1::Response SessionCommands::list_protocols() const {
  dts::v1::Response response;
  auto& out = *response.mutable_protocols();
  for (const session::Protocol& protocol : supervisor_.protocols()) *out.add_protocols() = protocol_info(protocol);
  return response;
}

dts::v1::Response SessionCommands::list(const dts::v1::ListSessionsRequest& request) {
  session::Recordings* recordings = supervisor_.recordings();
  if (recordings == nullptr) return nothing_is_recorded();
  const auto rows = recordings->catalogue().sessions(
      {.rig = request.rig(), .subject = request.subject(), .protocol = request.protocol(), .limit = limit_of(request.limit())});
  if (!rows) return error_response(rows.error());
  dts::v1::Response response;
  auto& out = *response.mutable_sessions();
  for (const record::SessionRow& row : *rows)
    *out.add_sessions() = session_record(recordings->corrected(row), supervisor_.planned_trials(row));
  return response;
}

dts::v1::Response SessionCommands::show(const dts::v1::ShowSessionRequest& request) {
  session::Recordings* recordings = supervisor_.recordings();
  if (recordings == nullptr) return nothing_is_recorded();
  const auto row = recordings->catalogue().session(request.session_id());
  if (!row) return error_response(row.error());
  const auto results = recordings->catalogue().results(request.session_id());
  if (!results) return error_response(results.error());
  dts::v1::Response response;
  *response.mutable_session_record() = session_record(recordings->corrected(*row), supervisor_.planned_trials(*row));
  add_fields(*row, *response.mutable_session_record());
  for (const record::ResultRow& result : *results) *response.mutable_session_record()->add_results() = session_result(result);
  return response;
}

dts::v1::Response SessionCommands::audit(const dts::v1::GetAuditRequest& request) {
  session::Recordings* recordings = supervisor_.recordings();
  if (recordings == nullptr) return nothing_is_recorded();
  const auto entries = recordings->catalogue().audit(limit_of(request.limit()));
  if (!entries) return error_response(entries.error());
  dts::v1::Response response;
  auto& out = *response.mutable_audit();
  for (const record::AuditEntry& entry : *entries) *out.add_entries() = audit_entry(entry);
  const auto verified = recordings->catalogue().verify_audit();
  if (verified) {
    out.set_verified_entries(*verified);
  } else {
    out.set_problem(core::to_string(verified.error()));
  }
  if (const std::string& owed = recordings->audit_problem(); !owed.empty() && verified) {
    out.set_problem("the newest entries are not written yet: " + owed);
  }
  return response;
}

dts::v1::Response SessionCommands::note_login(const dts::v1::NoteLoginRequest& request) {
  constexpr std::size_t kLongestAddress = 64;
  constexpr const char* kAddressLetters = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.:%_-";
  const std::string& address = request.address();
  const bool is_address =
      !address.empty() && address.size() <= kLongestAddress && address.find_first_not_of(kAddressLetters) == std::string::npos;
  if (!is_address || !(request.user().empty() || access::is_key_name(request.user()))) {
    return error_response({ErrorCode::InvalidArgument, "the note of a login names no user or no address", ""});
  }
  dts::v1::Response response;
  response.mutable_note_login();
  return response;
}

/// The session under way on the rig named, or on the only rig that has one; else the rig. Whatever else somebody typed there does not
/// belong into a trail that nobody can erase.
std::string SessionCommands::audited_target(const std::string& rig) {
  std::string target;
  for (const session::RigState& state : supervisor_.states()) {
    const bool is_meant = rig.empty() || state.rig.config().name == rig;
    const bool is_under_way = state.session.state != session::SessionState::Idle && state.session.state != session::SessionState::Failed;
    if (is_meant && !rig.empty()) target = state.rig.config().name;
    if (is_meant && is_under_way) target = state.session.id;
  }
  return target;
}

namespace {

/// "local", or "local:anna": what a gateway says of whom it logged in is as good as the gateway, hence both.
std::string who(const std::string& sender, const dts::v1::Request& request) {
  return access::is_key_name(request.on_behalf_of()) ? sender + ":" + request.on_behalf_of() : sender;
}

/// What a command on keys is about; what is no name was typed by somebody and stays out of the trail.
std::optional<std::string> key_of(const dts::v1::Request& request) {
  if (!request.has_add_key() && !request.has_revoke_key()) return std::nullopt;
  const std::string& name = request.has_add_key() ? request.add_key().name() : request.revoke_key().name();
  if (!access::is_key_name(name)) return "";
  return request.has_add_key() ? name + ":" + std::string(access::role_word(request.add_key().role())) : name;
}

/// "anna from 192.0.2.7, and 12 more"
std::string login_text(const dts::v1::NoteLoginRequest& login) {
  const std::string more = login.more() > 0 ? ", and " + std::to_string(login.more()) + " more" : "";
  return (login.user().empty() ? "unknown name" : login.user()) + " from " + login.address() + more;
}

}  // namespace

bool SessionCommands::is_audited(const dts::v1::Request& request, const dts::v1::Response& response) {
  const bool is_look = request.has_test_device() || request.has_get_audit() || request.has_list_keys();
  return !named(request).first.empty() && (!is_look || response.has_error());
}

void SessionCommands::enter_audit(const std::string& sender, const dts::v1::Request& request, const dts::v1::Response& response) {
  session::Recordings* recordings = supervisor_.recordings();
  auto [what, target] = named(request);
  if (recordings == nullptr || !is_audited(request, response)) return;
  const auto key = key_of(request);
  target = response.has_session() ? response.session().session_id() : key ? *key : audited_target(target);
  std::string result = response.has_error() ? std::string(core::name(static_cast<ErrorCode>(response.error().code()))) : "ok";
  if (response.has_note_login()) {
    target = login_text(request.note_login());
    if (request.note_login().is_refused()) result = "refused";
  }
  recordings->enter_audit({.utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns(),
                           .who = who(sender, request),
                           .what = what,
                           .target = target,
                           .result = result});
}

}  // namespace dts::ipc
