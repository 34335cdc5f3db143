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
#include "dts/export.h"
#include "dts/key.h"
#include "dts/v1/control.pb.h"

namespace dts::client {

/// Options of `ControlClient::open`.
struct ControlOptions {
  std::string endpoint;  ///< `Endpoints::control`
  /// Time limit for a whole command, over all tries (30 ms..1 day). Default: 3 s, or the longer limit that the protocol sets for the
  /// command: 15 s for `tare`, which the daemon answers when its average is complete, and 20 s for `stop_session` and `erase_subject`,
  /// which the daemon answers when the recording is closed or the files are removed.
  std::optional<std::chrono::milliseconds> timeout;
  int tries = 3;           ///< How often a request is sent before it fails with Unreachable: 1..10.
  std::optional<Key> key;  ///< For a daemon on another machine.
};

/// Sends commands to a daemon and waits for the answers.
///
/// If no answer arrives within timeout / tries, the client sends the request again over a new socket with the same request id. The daemon
/// executes the request only once (the "Lazy Pirate" of the ZeroMQ guide, chapter 4). Every answer is checked before it is returned: lists
/// are within limits, durations and lengths are finite and not negative, rates are positive. Other numbers may be NaN. Each command fails
/// with
///   - Unreachable: no answer arrived; the error names the endpoint and what to try,
///   - DataDamaged: the answer contradicts itself,
///   - InvalidArgument: a text of the request is not UTF-8,
///   - or the code, reason and hint that the daemon sent: also NotAllowed if the role of this client is not sufficient (proto/dts/v1/
///     control.proto names the role of each command), and LimitExceeded for more than 50 commands per second from another machine.
/// The comments below name only the codes that one command has besides these. The fields of the answers, with their units, are in
/// proto/dts/v1. Every command blocks until its answer arrives or its time limit has passed. Thread: one at a time.
class DTS_API ControlClient {
 public:
  /// Checks the options; does not connect yet. Fails with InvalidArgument for options out of range.
  [[nodiscard]] static Result<ControlClient> open(const ControlOptions& options);
  ~ControlClient();
  /// Moves. The source can then only be destroyed or assigned to.
  ControlClient(ControlClient&&) noexcept;
  /// Moves. The source can then only be destroyed or assigned to.
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

  /// Returns the present state of the daemon, its rigs, devices and sessions.
  [[nodiscard]] Result<v1::StatusSnapshot> status();
  /// Returns the rigs with plate, sensors, streams and stages.
  [[nodiscard]] Result<v1::ListRigsResponse> list_rigs();
  /// Returns the connected devices, and the kinds of device that a rig can use.
  [[nodiscard]] Result<v1::GetDevicesResponse> devices();
  /// Returns statistics of each channel of the rig's device over the last second, in the channel's unit. If the device does not stream, but
  /// the checks of its last start are known, the answer has them, the cause in `problem`, and no channels. Fails with NotFound for an
  /// unknown rig, with DeviceGone if the device does not stream and no checks are known, and with WrongState in its first second.
  [[nodiscard]] Result<v1::TestDeviceResponse> test_device(const std::string& rig);
  /// Starts a session and its recordings, one for each rig: `rig` leads, `companions` record at the same time. Fails with NotFound for an
  /// unknown rig, with InvalidArgument for an unknown protocol or an invalid value, with WrongState if the rig already has a session, is
  /// being tared or delivers no scans, with LimitExceeded if the disk is full or the request has more than 64 fields, and with Failed if
  /// the disk cannot be used.
  [[nodiscard]] Result<v1::SessionInfo> start_session(const v1::StartSessionRequest& request);
  /// Stops the session of a rig, on all its rigs, and waits until its recordings are closed. An empty rig means the only session. Fails
  /// with NotFound for an unknown rig, with WrongState if there is no session or it is stopping already, with InvalidArgument if `rig` is
  /// empty and several sessions are under way, and with Timeout if the recording is not closed in time: the daemon continues to close it.
  [[nodiscard]] Result<v1::SessionInfo> stop_session(const std::string& rig);
  /// Stops a session with all fields of the request: it can also abort the session, with a reason. Fails like the function above.
  [[nodiscard]] Result<v1::SessionInfo> stop_session(const v1::StopSessionRequest& request);
  /// Resumes an interrupted session as a new part of its recording. Fails with NotFound for an unknown ID or a session without a recording,
  /// and with WrongState if the session is complete, its protocol has changed, or its rig cannot start a session now.
  [[nodiscard]] Result<v1::SessionInfo> resume_session(const std::string& session_id);
  /// Executes one step of the protocol's trials and returns their new state. An empty rig means the only session. Fails with
  /// NotFound for an unknown rig, with WrongState if there is no running session with trials or the step is not possible now, and with
  /// InvalidArgument if `rig` is empty and several sessions are under way.
  [[nodiscard]] Result<v1::TrialStatus> trial(v1::TrialAction action, const std::string& rig);
  /// Returns sessions of the catalogue, newest first, with their parts and without their trials; 100 if the request has no limit.
  [[nodiscard]] Result<v1::ListSessionsResponse> list_sessions(const v1::ListSessionsRequest& request = {});
  /// Returns one session of the catalogue with its parts, trials and results. Fails with NotFound for an unknown ID.
  [[nodiscard]] Result<v1::SessionRecord> show_session(const std::string& session_id);
  /// Corrects a closed session and returns it. Fails with NotFound for an unknown session or trial, with InvalidArgument for a value that
  /// is not allowed or if nothing would change, with WrongState while the session runs or if it is deleted, and with LimitExceeded for more
  /// than 1000 corrections.
  [[nodiscard]] Result<v1::SessionRecord> correct_session(const v1::CorrectSessionRequest& request);
  /// Hides a closed session from all lists, or shows it again, and returns it. Fails with NotFound for an unknown ID, with InvalidArgument
  /// for a missing reason, and with WrongState while the session runs or if it is deleted already (or not).
  [[nodiscard]] Result<v1::SessionRecord> delete_session(const v1::DeleteSessionRequest& request);
  /// Returns all subject IDs with the number of their sessions.
  [[nodiscard]] Result<v1::ListSubjectsResponse> list_subjects();
  /// Returns everything that has this subject ID. Fails with NotFound if nothing has it.
  [[nodiscard]] Result<v1::SubjectRecord> show_subject(const std::string& subject);
  /// The same with the results of its newest 200 sessions.
  [[nodiscard]] Result<v1::SubjectRecord> show_subject_results(const std::string& subject);
  /// Adds or removes a note or a planned session of a subject and returns the subject. Needs the role operator. Fails with NotFound if
  /// nothing has this subject ID, and with InvalidArgument for a text that is not allowed.
  [[nodiscard]] Result<v1::SubjectRecord> edit_subject(const v1::EditSubjectRequest& edit);
  /// Erases a subject for ever and waits until its files are removed. Needs the role engineer. Fails with NotFound if nothing has this
  /// subject ID, with WrongState while a session of the subject runs, with NotAllowed if a recording is a link or outside the daemon's
  /// folder, and with Timeout if removing takes long: the daemon continues.
  [[nodiscard]] Result<v1::EraseSubjectResponse> erase_subject(const std::string& subject);
  /// Returns the protocols with their conditions and required fields.
  [[nodiscard]] Result<v1::ListProtocolsResponse> list_protocols();
  /// Returns the newest entries of the audit trail (0: the newest 100). A broken chain is not an error here: see `problem` in the answer.
  [[nodiscard]] Result<v1::GetAuditResponse> audit(std::uint32_t limit = 0);
  /// Marks the newest scan of a rig, or of every rig if `rig` is empty. `text` has 1..200 bytes. Fails with InvalidArgument for another
  /// length, with NotFound for an unknown rig, and with WrongState if there are no scans to mark.
  [[nodiscard]] Result<v1::MarkResponse> mark(const std::string& text, const std::string& rig);
  /// Tares the rig: what it reads now becomes zero. The plate or chair must be empty. Returns the baseline of each sensor (mm), or of each
  /// channel of a force plate (V).
  /// Fails with NotFound for an unknown rig, with WrongState if the device does not stream, if the rig has a session, or if the values
  /// are not steady or show a load, with Unsupported if the rig has no stage that tares, and with Timeout if the average is not complete
  /// after 10 s.
  [[nodiscard]] Result<v1::TareResponse> tare(const std::string& rig);

  /// Returns the keys of clients on other machines. `list_keys`, `add_key` and `revoke_key` need the role engineer; the last two return the
  /// changed list.
  [[nodiscard]] Result<v1::ListKeysResponse> list_keys();
  /// Adds the public key of a client with a name and a role. Fails with InvalidArgument if one of the three is not valid, with WrongState
  /// if the name or the key is already in the list, and with LimitExceeded if the list has 1000 keys.
  [[nodiscard]] Result<v1::ListKeysResponse> add_key(const v1::AddKeyRequest& request);
  /// Removes a key and closes its connections. Fails with NotFound for an unknown name.
  [[nodiscard]] Result<v1::ListKeysResponse> revoke_key(const std::string& name);

  /// Sends any command on behalf of another program's user (for example in a gateway) and returns the whole answer, checked like the other
  /// answers. The daemon sees the request id of `request`: a repeat with the same id returns the answer of the first request. Without an id
  /// every call is a new command. Returns an Error if the daemon rejects the command. Fails with InvalidArgument for a request without a
  /// command. Fails with Failed within 0.1 s after a stop is requested; the daemon may already have executed the command. The stop may be
  /// requested by any thread.
  [[nodiscard]] Result<v1::Response> forward(const v1::Request& request, const std::stop_token& stop = {});

  /// Returns how many messages, since `open`, did not answer the request of their time. More than a few: another program listens at the
  /// endpoint.
  [[nodiscard]] std::uint64_t ignored_replies() const noexcept;

 private:
  class Implementation;
  explicit ControlClient(std::unique_ptr<Implementation> implementation);
  [[nodiscard]] Result<std::unique_ptr<google::protobuf::Message>> answer_to(const google::protobuf::Message& command,
                                                                             const google::protobuf::Descriptor& answer);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::client
