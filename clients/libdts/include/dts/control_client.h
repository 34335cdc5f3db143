// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include "dts/error.h"
#include "dts/key.h"
#include "dts/v1/control.pb.h"

namespace dts::client {

struct ControlOptions {
  std::string endpoint;  ///< `Endpoints::control`
  /// Time limit for a whole command, over all tries (30 ms..1 day). Default: 3 s, or the longer limit that the protocol sets for the
  /// command: 15 s for `tare`, which the daemon answers when its average is complete, and 20 s for `stop_session`, which the daemon answers
  /// when the recording is closed.
  std::optional<std::chrono::milliseconds> timeout;
  int tries = 3;           ///< 1..10
  std::optional<Key> key;  ///< For a daemon on another machine.
};

/// Sends commands to a daemon and waits for the answers.
///
/// If no answer arrives within timeout / tries, the client sends the request again over a new socket with the same request id. The daemon
/// executes the request only once (the "Lazy Pirate" of the ZeroMQ guide, chapter 4). Every answer is checked before it is returned: lists
/// are within limits, numbers are finite, rates are positive. Each command fails with
///   - Unreachable: no answer arrived; the error names the endpoint and what to try,
///   - DataDamaged: the answer contradicts itself,
///   - or the code, reason and hint that the daemon sent.
/// Thread: one at a time.
class ControlClient {
 public:
  /// Checks the options; does not connect yet. Fails with InvalidArgument for options out of range.
  [[nodiscard]] static Result<ControlClient> open(const ControlOptions& options);
  ~ControlClient();
  ControlClient(ControlClient&&) noexcept;
  ControlClient& operator=(ControlClient&&) noexcept;
  ControlClient(const ControlClient&) = delete;
  ControlClient& operator=(const ControlClient&) = delete;

  /// Sends any command and returns its answer: `call<v1::TareResponse>(v1::TareRequest())`. Fails with InvalidArgument if the protocol does
  /// not know the command, or if the command has another type of answer.
  template <class Answer>
  [[nodiscard]] Result<Answer> call(const google::protobuf::Message& command) {
    auto answer = answer_to(command, *Answer::descriptor());
    if (!answer) return tl::make_unexpected(answer.error());
    return std::move(static_cast<Answer&>(**answer));
  }

  [[nodiscard]] Result<v1::StatusSnapshot> status();
  [[nodiscard]] Result<v1::ListRigsResponse> list_rigs();
  [[nodiscard]] Result<v1::GetDevicesResponse> devices();
  /// Returns statistics of the rig's device channels over the last second.
  [[nodiscard]] Result<v1::TestDeviceResponse> test_device(const std::string& rig);
  /// Starts a session. Fails with WrongState if the rig already has a session.
  [[nodiscard]] Result<v1::SessionInfo> start_session(const v1::StartSessionRequest& request);
  /// Ends a session and waits until its recording is closed. An empty rig means the only rig that has a session.
  [[nodiscard]] Result<v1::SessionInfo> stop_session(const std::string& rig);
  /// The same with all fields of the request: also aborts a session, with a reason.
  [[nodiscard]] Result<v1::SessionInfo> stop_session(const v1::StopSessionRequest& request);
  /// Resumes an interrupted session as a new part of its recording.
  [[nodiscard]] Result<v1::SessionInfo> resume_session(const std::string& session_id);
  /// Executes one step of the protocol's trials. An empty rig means the only rig that has a session.
  [[nodiscard]] Result<v1::TrialStatus> trial(v1::TrialAction action, const std::string& rig);
  /// Returns sessions of the catalogue, newest first, with their parts and without their trials.
  [[nodiscard]] Result<v1::ListSessionsResponse> list_sessions(const v1::ListSessionsRequest& request = {});
  [[nodiscard]] Result<v1::SessionRecord> show_session(const std::string& session_id);
  [[nodiscard]] Result<v1::ListProtocolsResponse> list_protocols();
  /// Returns the newest entries of the audit trail (0: the newest 100). A broken chain is not an error here: see `problem` in the answer.
  [[nodiscard]] Result<v1::GetAuditResponse> audit(std::uint32_t limit = 0);
  /// Marks the newest scan of a rig, or of every rig if `rig` is empty. `text` has 1..200 bytes.
  [[nodiscard]] Result<v1::MarkResponse> mark(const std::string& text, const std::string& rig);
  /// Tares the rig: the present deflections become zero.
  [[nodiscard]] Result<v1::TareResponse> tare(const std::string& rig);

  /// Returns the keys of clients on other machines. `list_keys`, `add_key` and `revoke_key` need the role engineer; the last two return the
  /// changed list.
  [[nodiscard]] Result<v1::ListKeysResponse> list_keys();
  [[nodiscard]] Result<v1::ListKeysResponse> add_key(const v1::AddKeyRequest& request);
  [[nodiscard]] Result<v1::ListKeysResponse> revoke_key(const std::string& name);

  /// Sends any command on behalf of another program's user (for example in a gateway) and returns the whole answer, checked like the other
  /// answers. The daemon sees the request id of `request`: a repeat with the same id returns the answer of the first request. Without an id
  /// every call is a new command. Returns an Error if the daemon refuses the command. Fails with InvalidArgument for a request without a
  /// command. Fails with Failed soon after a stop is requested; the daemon may already have executed the command.
  [[nodiscard]] Result<v1::Response> forward(const v1::Request& request, const std::stop_token& stop = {});

  /// Returns how many received messages did not answer the current request. More than a few: another program listens at the endpoint.
  [[nodiscard]] std::uint64_t ignored_replies() const noexcept;

 private:
  class Implementation;
  explicit ControlClient(std::unique_ptr<Implementation> implementation);
  [[nodiscard]] Result<std::unique_ptr<google::protobuf::Message>> answer_to(const google::protobuf::Message& command,
                                                                             const google::protobuf::Descriptor& answer);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::client
