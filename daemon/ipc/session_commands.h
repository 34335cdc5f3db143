// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/clock.h"
#include "core/log.h"
#include "dts/v1/control.pb.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// A session that was asked to stop and whose recording is not closed yet.
struct PendingStop {
  std::string rig;
  std::string session_id;
};

/// Commands on sessions, protocols and the catalogue: wire messages in, calls on the supervisor, wire messages out.
/// Thread: control.
class SessionCommands {
 public:
  SessionCommands(session::Supervisor& supervisor, core::Clock& clock) : supervisor_(supervisor), clock_(clock) {}

  [[nodiscard]] dts::v1::Response start(const dts::v1::StartSessionRequest& request);
  [[nodiscard]] dts::v1::Response resume(const dts::v1::ResumeSessionRequest& request);
  /// Fills `pending` when the answer has to wait; `response` is then incomplete.
  [[nodiscard]] dts::v1::Response stop(const dts::v1::StopSessionRequest& request, std::optional<PendingStop>& pending);
  [[nodiscard]] std::optional<dts::v1::Response> finish(const PendingStop& pending);
  [[nodiscard]] dts::v1::Response trial(const dts::v1::TrialRequest& request);
  [[nodiscard]] dts::v1::Response list_protocols() const;
  [[nodiscard]] dts::v1::Response list(const dts::v1::ListSessionsRequest& request);
  [[nodiscard]] dts::v1::Response show(const dts::v1::ShowSessionRequest& request);
  [[nodiscard]] dts::v1::Response audit(const dts::v1::GetAuditRequest& request);

  /// Only checks it: what is noted is the entry into the audit trail.
  [[nodiscard]] static dts::v1::Response note_login(const dts::v1::NoteLoginRequest& request);

  /// Enters a command that changes something into the audit trail with its answer: who, what, on what, how it ended. `sender` is "local" or
  /// "key:NAME". The texts of people (labels, markers, fields) do not go there.
  /// Whether a command with this answer is entered at all: what changes something, and what only an engineer may look at, when it failed.
  [[nodiscard]] static bool is_audited(const dts::v1::Request& request, const dts::v1::Response& response);
  void enter_audit(const std::string& sender, const dts::v1::Request& request, const dts::v1::Response& response);

 private:
  [[nodiscard]] std::string audited_target(const std::string& rig);

  session::Supervisor& supervisor_;
  core::Clock& clock_;
};

}  // namespace dts::ipc
