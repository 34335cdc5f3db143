// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "dts/v1/control.pb.h"
#include "ipc/encode.h"
#include "ipc/key_commands.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// A requested tare without an answer yet.
struct PendingTare {
  std::string rig;
  std::uint64_t request = 0;  ///< Number that the supervisor assigned.
};

/// A stopping session whose recording is not closed yet.
struct PendingStop {
  std::string rig;
  std::string session_id;
  std::string problem{};  ///< For the answer: why the reason is left out.
};

/// An erasure whose files are being removed.
struct PendingErasure {};

/// A command without an answer yet.
using Pending = std::variant<PendingTare, PendingStop, PendingErasure>;

/// Executes commands: converts requests to calls of the supervisor, and their results to responses. Uses no sockets.
/// Thread: control.
class CommandHandler {
 public:
  CommandHandler(session::Supervisor& supervisor, core::Clock& clock, Identity identity, std::vector<std::string> notices,
                 KeyCommands keys);

  struct Answer {
    dts::v1::Response response;
    std::optional<Pending> pending{};  ///< If set, `response` is not complete: call `finish` until it returns a response.
  };
  /// Executes a request. Answers every request, even an invalid one. `author`: who sent it, see `author_of`.
  [[nodiscard]] Answer execute(const dts::v1::Request& request, const std::string& author = "local");
  /// Returns the answer to a pending command, or nothing if there is none yet.
  [[nodiscard]] std::optional<dts::v1::Response> finish(const Pending& pending);
  /// Returns the answer after a timeout. Cancels a pending tare, which must not run minutes later without a request.
  [[nodiscard]] dts::v1::Response give_up(const Pending& pending);

  [[nodiscard]] dts::v1::StatusSnapshot status();
  /// Counts a rejected message; shown in the status.
  void count_rejected() noexcept { ++rejected_total_; }

 private:
  [[nodiscard]] Answer run(const dts::v1::Request& request, const std::string& author);
  dts::v1::Response status_response();
  dts::v1::Response list_rigs();
  dts::v1::Response devices();
  dts::v1::Response test_device(const dts::v1::TestDeviceRequest& request);
  dts::v1::Response mark(const dts::v1::MarkRequest& request);
  Answer tare(const dts::v1::TareRequest& request);
  [[nodiscard]] std::optional<dts::v1::Response> finish_tare(const PendingTare& pending);

  // session_commands.cpp
  dts::v1::Response start_session(const dts::v1::StartSessionRequest& request);
  dts::v1::Response resume_session(const dts::v1::ResumeSessionRequest& request);
  Answer stop_session(const dts::v1::StopSessionRequest& request);
  [[nodiscard]] std::optional<dts::v1::Response> finish_stop(const PendingStop& pending);
  dts::v1::Response trial(const dts::v1::TrialRequest& request);
  dts::v1::Response list_protocols();
  dts::v1::Response list_sessions(const dts::v1::ListSessionsRequest& request);
  dts::v1::Response show_session(const dts::v1::ShowSessionRequest& request);
  dts::v1::Response audit(const dts::v1::GetAuditRequest& request);
  [[nodiscard]] dts::v1::Response session_answer(const record::SessionRow& row);

  // record_commands.cpp
  dts::v1::Response correct_session(const dts::v1::CorrectSessionRequest& request, const std::string& author);
  dts::v1::Response delete_session(const dts::v1::DeleteSessionRequest& request, const std::string& author);
  dts::v1::Response list_subjects();
  dts::v1::Response show_subject(const dts::v1::ShowSubjectRequest& request);
  dts::v1::Response edit_subject(const dts::v1::EditSubjectRequest& request, const std::string& author);
  Answer erase_subject(const dts::v1::EraseSubjectRequest& request, const std::string& author);
  [[nodiscard]] std::optional<dts::v1::Response> finish_erasure();

  /// Only checks the request; the audit trail records the login.
  static dts::v1::Response note_login(const dts::v1::NoteLoginRequest& request);

  session::Supervisor& supervisor_;
  KeyCommands keys_;
  core::Clock& clock_;
  Identity identity_;
  std::vector<std::string> notices_;
  std::uint64_t rejected_total_ = 0;
};

/// Returns a response with `error`.
[[nodiscard]] dts::v1::Response error_response(const core::Error& error);

}  // namespace dts::ipc
