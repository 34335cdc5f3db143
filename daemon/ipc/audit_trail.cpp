// SPDX-License-Identifier: Apache-2.0
#include "ipc/audit_trail.h"

#include <optional>

#include "access/client_key.h"
#include "dts/wire/options.h"

namespace dts::ipc {
namespace {

/// Returns the command's name in the trail: a special name for some commands, else its option `audit`.
std::string audit_name(const dts::v1::Request& request) {
  if (request.has_stop_session() && request.stop_session().is_abort()) return "abort_session";
  if (request.has_delete_session() && request.delete_session().is_restore()) return "restore_session";
  switch (request.trial().action()) {
    case dts::v1::TRIAL_ACTION_NEXT: return "trial_next";
    case dts::v1::TRIAL_ACTION_REDO: return "trial_redo";
    case dts::v1::TRIAL_ACTION_REJECT: return "trial_reject";
    case dts::v1::TRIAL_ACTION_UNDO: return "trial_undo";
    default: return wire::rules_of(request).audit();
  }
}

/// Returns the field `rig` or `session_id` of the command; empty without such a field.
std::string asked_target(const dts::v1::Request& request) {
  const auto& command = request.GetReflection()->GetMessage(request, wire::command_field(request));
  for (const char* name : {"rig", "session_id"}) {
    if (const auto* field = command.GetDescriptor()->FindFieldByName(name)) return command.GetReflection()->GetString(command, field);
  }
  return {};
}

/// Returns the ID of the session in progress on `rig` (empty: on any rig); else the name of the rig if it exists; else nothing, so that the
/// trail contains no text that a person typed.
std::string known_target(session::Supervisor& supervisor, const std::string& rig) {
  std::string target;
  for (const session::RigState& state : supervisor.states()) {
    const bool is_meant = rig.empty() || state.rig.config().name == rig;
    const bool is_under_way = state.session.state != session::SessionState::Idle && state.session.state != session::SessionState::Failed;
    if (is_meant && !rig.empty()) target = state.rig.config().name;
    if (is_meant && is_under_way) target = state.session.id;
  }
  return target;
}

/// Returns the ID if the catalogue has this session; else nothing.
std::string known_session(session::Supervisor& supervisor, const std::string& id) {
  const auto session = supervisor.recordings().catalogue().session(id);
  return session ? session->id : "";
}

/// Returns the name of the key that a command adds (with its role) or revokes; empty if the name is invalid; nothing for other commands.
std::optional<std::string> key_of(const dts::v1::Request& request) {
  if (!request.has_add_key() && !request.has_revoke_key()) return std::nullopt;
  const std::string& name = request.has_add_key() ? request.add_key().name() : request.revoke_key().name();
  if (!access::is_key_name(name)) return "";
  return request.has_add_key() ? name + ":" + std::string(access::role_word(request.add_key().role())) : name;
}

/// Returns a text such as "anna from 192.0.2.7, and 12 more".
std::string login_text(const dts::v1::NoteLoginRequest& login) {
  const std::string more = login.more() > 0 ? ", and " + std::to_string(login.more()) + " more" : "";
  return (login.user().empty() ? "unknown name" : login.user()) + " from " + login.address() + more;
}

/// Returns what was changed, without the subject ID and the text.
std::string edit_text(const dts::v1::EditSubjectRequest& edit) {
  switch (edit.change_case()) {
    case dts::v1::EditSubjectRequest::kAddNote: return "note added";
    case dts::v1::EditSubjectRequest::kRemoveNote: return "note removed";
    case dts::v1::EditSubjectRequest::kAddPlan: return "session planned";
    case dts::v1::EditSubjectRequest::kRemovePlan: return "planned session removed";
    case dts::v1::EditSubjectRequest::CHANGE_NOT_SET: break;
  }
  return "";
}

std::string target_of(session::Supervisor& supervisor, const dts::v1::Request& request, const dts::v1::Response& response) {
  if (response.has_note_login()) return login_text(request.note_login());
  if (response.has_session()) return response.session().session_id();
  if (const auto key = key_of(request)) return *key;
  if (request.has_erase_subject()) return "";  // never the subject ID
  if (request.has_edit_subject()) return edit_text(request.edit_subject());
  if (request.has_correct_session() || request.has_delete_session()) return known_session(supervisor, asked_target(request));
  return known_target(supervisor, asked_target(request));
}

std::string result_of(const dts::v1::Request& request, const dts::v1::Response& response) {
  if (response.has_error()) return std::string(core::name(static_cast<core::ErrorCode>(response.error().code())));
  return request.note_login().is_refused() ? "refused" : "ok";
}

}  // namespace

std::string author_of(const std::string& sender, const dts::v1::Request& request) {
  return access::is_key_name(request.on_behalf_of()) ? sender + ":" + request.on_behalf_of() : sender;
}

bool is_audited(const dts::v1::Request& request, const dts::v1::Response& response) {
  const dts::v1::CommandRules& rules = wire::rules_of(request);
  return !rules.audit().empty() && !response.has_erased() && (rules.is_change() || response.has_error());
}

void enter_audit(session::Supervisor& supervisor, core::Clock& clock, const std::string& sender, const dts::v1::Request& request,
                 const dts::v1::Response& response) {
  if (!is_audited(request, response)) return;
  supervisor.recordings().enter_audit({.utc_ns = clock.now_ns() + clock.utc_minus_monotonic_ns(),
                                       .who = author_of(sender, request),
                                       .what = audit_name(request),
                                       .target = target_of(supervisor, request, response),
                                       .result = result_of(request, response)});
}

}  // namespace dts::ipc
