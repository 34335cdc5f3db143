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
  /// For a whole command, all tries together (30 ms..1 day). Default: 3 s, or what the protocol says of the command: 15 s for `tare`, which
  /// is answered when its average is complete, and 20 s for `stop_session`, which is answered when the recording is closed.
  std::optional<std::chrono::milliseconds> timeout;
  int tries = 3;           ///< 1..10
  std::optional<Key> key;  ///< For a daemon on another machine.
};

/// Sends commands to a daemon and waits for the answers.
///
/// A request that is not answered within timeout / tries is sent again over a new socket with the same request id; the
/// daemon executes it once (the "Lazy Pirate" of the ZeroMQ guide, chapter 4). Every answer is checked before it is
/// returned: lists are within limits, numbers finite, rates positive. Each command fails with
///   - Unreachable: nobody answers; says the endpoint and what to try,
///   - DataDamaged: the answer contradicts itself,
///   - or the code, reason and hint that the daemon gives.
/// Thread: one at a time.
class ControlClient {
 public:
  /// Contacts nobody yet. Fails with InvalidArgument for options out of range.
  [[nodiscard]] static Result<ControlClient> open(const ControlOptions& options);
  ~ControlClient();
  ControlClient(ControlClient&&) noexcept;
  ControlClient& operator=(ControlClient&&) noexcept;
  ControlClient(const ControlClient&) = delete;
  ControlClient& operator=(const ControlClient&) = delete;

  /// Sends any command and returns its answer: `call<v1::TareResponse>(v1::TareRequest())`. InvalidArgument if the protocol does not know
  /// the command, or if something else answers it.
  template <class Answer>
  [[nodiscard]] Result<Answer> call(const google::protobuf::Message& command) {
    auto answer = answer_to(command, *Answer::descriptor());
    if (!answer) return tl::make_unexpected(answer.error());
    return std::move(static_cast<Answer&>(**answer));
  }

  [[nodiscard]] Result<v1::StatusSnapshot> status();
  [[nodiscard]] Result<v1::ListRigsResponse> list_rigs();
  [[nodiscard]] Result<v1::GetDevicesResponse> devices();
  /// Statistics of the rig's device channels over the last second.
  [[nodiscard]] Result<v1::TestDeviceResponse> test_device(const std::string& rig);
  /// WrongState when the rig already has a session.
  [[nodiscard]] Result<v1::SessionInfo> start_session(const v1::StartSessionRequest& request);
  /// Ends a session and waits until its recording is closed. An empty rig means the only one that has a session.
  [[nodiscard]] Result<v1::SessionInfo> stop_session(const std::string& rig);
  /// The same, also for an abort with its reason.
  [[nodiscard]] Result<v1::SessionInfo> stop_session(const v1::StopSessionRequest& request);
  /// Goes on with a session that was interrupted, as a new part of its recording.
  [[nodiscard]] Result<v1::SessionInfo> resume_session(const std::string& session_id);
  /// One step of the protocol's trials. An empty rig means the only one that has a session.
  [[nodiscard]] Result<v1::TrialStatus> trial(v1::TrialAction action, const std::string& rig);
  /// Sessions of the catalogue, newest first, with their parts and without their trials.
  [[nodiscard]] Result<v1::ListSessionsResponse> list_sessions(const v1::ListSessionsRequest& request = {});
  [[nodiscard]] Result<v1::SessionRecord> show_session(const std::string& session_id);
  [[nodiscard]] Result<v1::ListProtocolsResponse> list_protocols();
  /// The newest entries of the audit trail (0: 100). That its chain is broken is no error here: see `problem`.
  [[nodiscard]] Result<v1::GetAuditResponse> audit(std::uint32_t limit = 0);
  /// Marks the newest scan of a rig, or of every rig for an empty name. `text` has 1..200 bytes.
  [[nodiscard]] Result<v1::MarkResponse> mark(const std::string& text, const std::string& rig);
  /// Takes the present deflections as zero.
  [[nodiscard]] Result<v1::TareResponse> tare(const std::string& rig);

  /// Keys of clients on other machines; needs the role engineer, as do the two below, which answer how it is afterwards.
  [[nodiscard]] Result<v1::ListKeysResponse> list_keys();
  [[nodiscard]] Result<v1::ListKeysResponse> add_key(const v1::AddKeyRequest& request);
  [[nodiscard]] Result<v1::ListKeysResponse> revoke_key(const std::string& name);

  /// Sends any command for somebody else (a gateway) and returns the whole answer, checked like the others. The daemon sees the request id
  /// of `request`: who sends the same again gets the answer of the first time (without an id it is a new command each time). What the
  /// daemon refuses is a Failure here too. InvalidArgument for a request without a command; Failed soon after `stop` was asked for: the
  /// daemon may have executed it.
  [[nodiscard]] Result<v1::Response> forward(const v1::Request& request, const std::stop_token& stop = {});

  /// Messages received that were no answer to the request under way. More than a few: something else listens there.
  [[nodiscard]] std::uint64_t ignored_replies() const noexcept;

 private:
  class Implementation;
  explicit ControlClient(std::unique_ptr<Implementation> implementation);
  [[nodiscard]] Result<std::unique_ptr<google::protobuf::Message>> answer_to(const google::protobuf::Message& command,
                                                                             const google::protobuf::Descriptor& answer);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::client
