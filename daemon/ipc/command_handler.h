// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "access/authenticator.h"
#include "dts/v1/control.pb.h"
#include "ipc/encode.h"
#include "ipc/key_commands.h"
#include "ipc/session_commands.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// A tare that was asked for and is not answered yet.
struct PendingTare {
  std::string rig;
  std::uint64_t request = 0;  ///< Number given by the supervisor.
};

/// A command whose answer is not known yet.
using Pending = std::variant<PendingTare, PendingStop>;

/// Executes commands: wire messages in, calls on the supervisor, wire messages out. Knows no sockets.
/// Thread: control.
class CommandHandler {
 public:
  /// `authenticator` (nullptr: there is no network) outlives the handler.
  CommandHandler(session::Supervisor& supervisor, core::Clock& clock, Identity identity, std::vector<std::string> notices, KeyCommands keys,
                 const access::Authenticator* authenticator = nullptr);

  struct Answer {
    dts::v1::Response response;
    std::optional<Pending> pending{};  ///< Set: `response` is not complete; ask `finish` until it is.
  };
  /// Total: every request, however senseless, gets an answer.
  [[nodiscard]] Answer execute(const dts::v1::Request& request);
  /// The answer to a pending command, or nothing yet.
  [[nodiscard]] std::optional<dts::v1::Response> finish(const Pending& pending);
  /// The answer when nobody wants to wait any longer. A tare is withdrawn: it must not happen minutes later, unasked.
  [[nodiscard]] dts::v1::Response give_up(const Pending& pending);
  /// Enters a command with its answer into the audit trail, if it changes something.
  void enter_audit(const std::string& sender, const dts::v1::Request& request, const dts::v1::Response& response) {
    sessions_.enter_audit(sender, request, response);
  }
  /// Whether `enter_audit` would enter anything: what changes something, and what an engineer alone may see when it was refused.
  [[nodiscard]] static bool is_audited(const dts::v1::Request& request, const dts::v1::Response& response) {
    return SessionCommands::is_audited(request, response);
  }
  /// Whether, since the last call, a client's key has gone or changed.
  [[nodiscard]] bool has_lost_keys() noexcept { return keys_.has_lost(); }
  /// Other machines cannot connect any more, or can again; shown in the status.
  void note_remote_problem(bool is_there) noexcept { has_remote_problem_ = is_there; }

  [[nodiscard]] dts::v1::StatusSnapshot status();
  /// Counts a message that was no request at all; shown in the status.
  void count_rejected() noexcept { ++rejected_total_; }

 private:
  [[nodiscard]] dts::v1::Response execute_session(const dts::v1::Request& request, std::optional<Pending>& pending);
  [[nodiscard]] std::optional<dts::v1::Response> finish_tare(const PendingTare& pending);
  dts::v1::Response mark(const dts::v1::MarkRequest& request);
  dts::v1::Response list_rigs();
  dts::v1::Response devices();
  dts::v1::Response test_device(const dts::v1::TestDeviceRequest& request);
  static void add_checks(const device::DeviceReport& report, dts::v1::TestDeviceResponse& out);

  session::Supervisor& supervisor_;
  SessionCommands sessions_;
  KeyCommands keys_;
  const access::Authenticator* authenticator_;
  core::Clock& clock_;
  Identity identity_;
  std::vector<std::string> notices_;
  std::uint64_t rejected_total_ = 0;
  bool has_remote_problem_ = false;
};

/// A response that carries `error`.
[[nodiscard]] dts::v1::Response error_response(const core::Error& error);

}  // namespace dts::ipc
