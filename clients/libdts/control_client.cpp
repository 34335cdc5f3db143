// SPDX-License-Identifier: Apache-2.0
#include "dts/control_client.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <random>
#include <utility>
#include <zmq.hpp>

#include "curve.h"
#include "dts/endpoints.h"
#include "dts/wire/options.h"
#include "try.h"
#include "wire_check.h"

namespace dts::client {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t kAnswerSocketBytes = 4 * static_cast<std::int64_t>(kMaxAnswerBytes);
constexpr std::size_t kLongestText = 2000;
constexpr std::size_t kLongestRequestBytes = 4 * 1024;  // as the daemon's control socket
constexpr milliseconds kTimeout{3000};
constexpr milliseconds kLookForStop{50};

/// Returns 128 random bits, so that no two commands of any clients have the same id.
std::string new_request_id() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string id;
  for (int digit = 0; digit < 32; ++digit) id += kDigits[random() % kDigits.size()];
  return id;
}

/// Serialises deterministically: the daemon compares the bytes of a repeated request with the first ones, and the order of protobuf maps is
/// otherwise not defined.
std::string bytes_of(const v1::Request& request) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream out(&stream);
    out.SetSerializationDeterministic(true);
    request.SerializeToCodedStream(&out);
  }
  return bytes;
}

Error to_error(const v1::Error& wire) {
  const bool is_known = wire.code() >= v1::ERROR_CODE_FAILED && wire.code() <= v1::ERROR_CODE_INTERNAL;
  const auto code = is_known ? static_cast<ErrorCode>(wire.code()) : ErrorCode::Failed;
  std::string what = wire.what().empty() ? "the daemon rejected the command and gave no reason" : wire.what().substr(0, kLongestText);
  return {code, std::move(what), wire.hint().substr(0, kLongestText)};
}

Result<void> check_options(const ControlOptions& options) {
  constexpr milliseconds kShortest{30};
  constexpr milliseconds kLongest{std::chrono::hours(24)};
  if (options.endpoint.empty()) {
    return fail(ErrorCode::InvalidArgument, "the control address of the daemon is not known",
                "give it with --endpoint URI or DTSD_CONTROL");
  }
  if (options.timeout && (*options.timeout < kShortest || *options.timeout > kLongest)) {
    return fail(ErrorCode::InvalidArgument, "the timeout must be from 0.03 s to 86400 s");
  }
  if (options.tries < 1 || options.tries > 10) return fail(ErrorCode::InvalidArgument, "tries must be from 1 to 10");
  return {};
}

std::string seconds(milliseconds time) {
  const std::string tenths = std::to_string((time.count() + 50) / 100 % 10);
  return std::to_string((time.count() + 50) / 1000) + "." + tenths + " s";
}

}  // namespace

class [[gnu::visibility("hidden")]] ControlClient::Implementation {
 public:
  explicit Implementation(ControlOptions options) : options_(std::move(options)) {}

  /// Sets a request id if there is none, sends the request and waits for the answer. Fails unless the answer belongs to the command and
  /// passes its checks.
  Result<v1::Response> answer(v1::Request && request, const std::stop_token& stop);

  [[nodiscard]] std::uint64_t ignored_replies() const noexcept { return ignored_replies_; }

 private:
  Result<v1::Response> exchange(v1::Request && request, const std::stop_token& stop);
  [[nodiscard]] milliseconds timeout_of(const v1::Request& request) const;
  void reopen();
  void send(const std::string& request);
  [[nodiscard]] std::optional<v1::Response> wait_for(const std::string& request_id, Clock::time_point deadline,
                                                     const std::stop_token& stop);
  [[nodiscard]] std::optional<v1::Response> receive(const std::string& request_id);
  [[nodiscard]] tl::unexpected<Error> unreachable(milliseconds timeout, std::uint64_t ignored) const;

  ControlOptions options_;
  zmq::context_t context_{1};
  zmq::socket_t socket_;
  std::uint64_t ignored_replies_ = 0;
};

Result<v1::Response> ControlClient::Implementation::answer(v1::Request&& request, const std::stop_token& stop) {
  const auto* wanted = wire::answer_field(request);
  if (wanted == nullptr) {
    return fail(ErrorCode::InvalidArgument, "the request has no command that this version knows");
  }
  try {
    DTS_TRY_ASSIGN(auto response, exchange(std::move(request), stop));
    if (response.has_error()) return tl::make_unexpected(to_error(response.error()));
    if (static_cast<int>(response.result_case()) != wanted->number()) {
      return fail(ErrorCode::DataDamaged, "the answer of the daemon does not match the command",
                  "check that dtsd and this program have the same version");
    }
    DTS_TRY(check(response));
    return response;
  } catch (const zmq::error_t& error) {
    const bool is_address = error.num() == EINVAL || error.num() == EPROTONOSUPPORT || error.num() == ENODEV;
    return fail(is_address ? ErrorCode::InvalidArgument : ErrorCode::Internal,
                "cannot use the control address '" + options_.endpoint + "': " + error.what());
  }
}

milliseconds ControlClient::Implementation::timeout_of(const v1::Request& request) const {
  return options_.timeout.value_or(std::max<milliseconds>(kTimeout, std::chrono::seconds(wire::rules_of(request).timeout_s())));
}

Result<v1::Response> ControlClient::Implementation::exchange(v1::Request&& request, const std::stop_token& stop) {
  DTS_TRY(probe(options_.endpoint));
  if (request.request_id().empty()) request.set_request_id(new_request_id());
  const std::string bytes = bytes_of(request);
  // protobuf serialises invalid UTF-8 without an error, but the daemon cannot parse it, so such a request would never be answered.
  if (v1::Request echo; !echo.ParseFromString(bytes)) return fail(ErrorCode::InvalidArgument, "the text is not valid UTF-8");
  // The daemon ends the connection for a longer one, so such a request would never be answered either.
  if (bytes.size() > kLongestRequestBytes) {
    return fail(
        ErrorCode::InvalidArgument,
        "the command has " + std::to_string(bytes.size()) + " bytes, and the daemon accepts " + std::to_string(kLongestRequestBytes),
        "shorten its texts");
  }
  const milliseconds timeout = timeout_of(request);
  const std::uint64_t ignored_before = ignored_replies_;
  for (int attempt = 0; attempt < options_.tries; ++attempt) {
    if (attempt > 0 || !socket_) reopen();
    send(bytes);
    auto response = wait_for(request.request_id(), Clock::now() + timeout / options_.tries, stop);
    if (stop.stop_requested()) return fail(ErrorCode::Failed, "stopped waiting for the answer: this program ends");
    if (response) return std::move(*response);
  }
  socket_.close();
  return unreachable(timeout, ignored_replies_ - ignored_before);
}

void ControlClient::Implementation::reopen() {
  socket_ = zmq::socket_t(context_, zmq::socket_type::dealer);
  socket_.set(zmq::sockopt::linger, 0);
  socket_.set(zmq::sockopt::maxmsgsize, kAnswerSocketBytes);
  if (options_.key) use(socket_, *options_.key);
  socket_.connect(options_.endpoint);
}

/// Uses the envelope of a REQ socket (an empty frame first), because every ROUTER that serves REQ understands it.
void ControlClient::Implementation::send(const std::string& request) {
  socket_.send(zmq::message_t(), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
  socket_.send(zmq::buffer(request), zmq::send_flags::dontwait);
}

std::optional<v1::Response> ControlClient::Implementation::wait_for(const std::string& request_id, Clock::time_point deadline,
                                                                    const std::stop_token& stop) {
  for (auto now = Clock::now(); now < deadline && !stop.stop_requested(); now = Clock::now()) {
    const milliseconds left = std::chrono::ceil<milliseconds>(deadline - now);
    const milliseconds turn = stop.stop_possible() ? std::min(left, kLookForStop) : left;
    zmq::pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
    // A signal ends the wait early; the deadline decides whether the loop continues.
    zmq_poll(&item, 1, static_cast<long>(turn.count()));
    if (auto response = receive(request_id)) return response;
  }
  return std::nullopt;
}

/// Reads one message. Returns nothing if none waits, or if it does not answer `request_id`; the latter is counted.
std::optional<v1::Response> ControlClient::Implementation::receive(const std::string& request_id) {
  zmq::message_t frame;
  int frames = 0;
  bool has_envelope = true;
  do {
    if (!socket_.recv(frame, zmq::recv_flags::dontwait)) return std::nullopt;
    ++frames;
    if (frame.more()) has_envelope = has_envelope && frame.size() == 0;
  } while (frame.more());
  v1::Response response;
  const bool is_response = frames <= 2 && has_envelope && frame.size() <= kMaxAnswerBytes &&
                           response.ParseFromArray(frame.data(), static_cast<int>(frame.size()));
  // If the daemon cannot parse a request, its error answer has no request id.
  const bool is_rejection = is_response && response.request_id().empty() && response.has_error();
  if (is_response && (response.request_id() == request_id || is_rejection)) return response;
  ++ignored_replies_;
  return std::nullopt;
}

tl::unexpected<Error> ControlClient::Implementation::unreachable(milliseconds timeout, std::uint64_t ignored) const {
  const std::string where = options_.endpoint + " within " + seconds(timeout) + " (" + std::to_string(options_.tries) + " tries)";
  if (ignored > 0) {
    return fail(ErrorCode::Unreachable, "no valid answer from " + where + "; " + std::to_string(ignored) + " other messages arrived",
                "check that dtsd listens at this address (--endpoint) and has the same version");
  }
  if (options_.key) {
    return fail(ErrorCode::Unreachable, "no answer from " + where,
                "on the daemon's machine, check that dtsd and dts-relay run, that dtsd.toml has [network], and that it has the key '" +
                    options_.key->name + "': dtsctl key list");
  }
  return fail(ErrorCode::Unreachable, "no answer from " + where,
              "check that dtsd runs: systemctl status dtsd; check the address: --endpoint URI");
}

Result<ControlClient> ControlClient::open(const ControlOptions& options) {
  DTS_TRY(check_options(options));
  return ControlClient(std::make_unique<Implementation>(options));
}

ControlClient::ControlClient(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
ControlClient::~ControlClient() = default;
ControlClient::ControlClient(ControlClient&&) noexcept = default;
ControlClient& ControlClient::operator=(ControlClient&&) noexcept = default;
std::uint64_t ControlClient::ignored_replies() const noexcept { return implementation_->ignored_replies(); }

Result<v1::Response> ControlClient::forward(const v1::Request& request, const std::stop_token& stop) {
  return implementation_->answer(v1::Request(request), stop);
}

Result<std::unique_ptr<google::protobuf::Message>> ControlClient::answer_to(const google::protobuf::Message& command,
                                                                            const google::protobuf::Descriptor& answer) {
  const auto* commands = v1::Request::descriptor()->FindOneofByName("command");
  v1::Request request;
  for (int index = 0; index < commands->field_count(); ++index) {
    const auto* field = commands->field(index);
    if (field->message_type() == command.GetDescriptor()) request.GetReflection()->MutableMessage(&request, field)->CopyFrom(command);
  }
  const auto* field = wire::answer_field(request);
  if (field == nullptr || field->message_type() != &answer) {
    return fail(ErrorCode::InvalidArgument, command.GetTypeName() + " is not a command with the answer " + std::string(answer.full_name()));
  }
  DTS_TRY_ASSIGN(auto response, forward(request));
  return std::unique_ptr<google::protobuf::Message>(response.GetReflection()->ReleaseMessage(&response, field));
}

Result<v1::StatusSnapshot> ControlClient::status() { return call<v1::StatusSnapshot>(v1::StatusRequest()); }

Result<v1::ListRigsResponse> ControlClient::list_rigs() { return call<v1::ListRigsResponse>(v1::ListRigsRequest()); }

Result<v1::GetDevicesResponse> ControlClient::devices() { return call<v1::GetDevicesResponse>(v1::GetDevicesRequest()); }

Result<v1::TestDeviceResponse> ControlClient::test_device(const std::string& rig) {
  v1::TestDeviceRequest command;
  command.set_rig(rig);
  return call<v1::TestDeviceResponse>(command);
}

Result<v1::SessionInfo> ControlClient::start_session(const v1::StartSessionRequest& command) { return call<v1::SessionInfo>(command); }

Result<v1::SessionInfo> ControlClient::stop_session(const std::string& rig) {
  v1::StopSessionRequest command;
  command.set_rig(rig);
  return stop_session(command);
}

Result<v1::SessionInfo> ControlClient::stop_session(const v1::StopSessionRequest& command) { return call<v1::SessionInfo>(command); }

Result<v1::SessionInfo> ControlClient::resume_session(const std::string& session_id) {
  v1::ResumeSessionRequest command;
  command.set_session_id(session_id);
  return call<v1::SessionInfo>(command);
}

Result<v1::TrialStatus> ControlClient::trial(v1::TrialAction action, const std::string& rig) {
  v1::TrialRequest command;
  command.set_action(action);
  command.set_rig(rig);
  return call<v1::TrialStatus>(command);
}

Result<v1::ListSessionsResponse> ControlClient::list_sessions(const v1::ListSessionsRequest& command) {
  return call<v1::ListSessionsResponse>(command);
}

Result<v1::SessionRecord> ControlClient::show_session(const std::string& session_id) {
  v1::ShowSessionRequest command;
  command.set_session_id(session_id);
  return call<v1::SessionRecord>(command);
}

Result<v1::SessionRecord> ControlClient::correct_session(const v1::CorrectSessionRequest& command) {
  return call<v1::SessionRecord>(command);
}

Result<v1::SessionRecord> ControlClient::delete_session(const v1::DeleteSessionRequest& command) {
  return call<v1::SessionRecord>(command);
}

Result<v1::ListSubjectsResponse> ControlClient::list_subjects() { return call<v1::ListSubjectsResponse>(v1::ListSubjectsRequest()); }

Result<v1::SubjectRecord> ControlClient::show_subject(const std::string& subject) {
  v1::ShowSubjectRequest command;
  command.set_subject(subject);
  return call<v1::SubjectRecord>(command);
}

Result<v1::SubjectRecord> ControlClient::show_subject_results(const std::string& subject) {
  v1::ShowSubjectRequest command;
  command.set_subject(subject);
  command.set_with_results(true);
  return call<v1::SubjectRecord>(command);
}

Result<v1::SubjectRecord> ControlClient::edit_subject(const v1::EditSubjectRequest& edit) { return call<v1::SubjectRecord>(edit); }

Result<v1::EraseSubjectResponse> ControlClient::erase_subject(const std::string& subject) {
  v1::EraseSubjectRequest command;
  command.set_subject(subject);
  return call<v1::EraseSubjectResponse>(command);
}

Result<v1::ListProtocolsResponse> ControlClient::list_protocols() { return call<v1::ListProtocolsResponse>(v1::ListProtocolsRequest()); }

Result<v1::GetAuditResponse> ControlClient::audit(std::uint32_t limit) {
  v1::GetAuditRequest command;
  command.set_limit(limit);
  return call<v1::GetAuditResponse>(command);
}

Result<v1::MarkResponse> ControlClient::mark(const std::string& text, const std::string& rig) {
  v1::MarkRequest command;
  command.set_text(text);
  command.set_rig(rig);
  return call<v1::MarkResponse>(command);
}

Result<v1::TareResponse> ControlClient::tare(const std::string& rig) {
  v1::TareRequest command;
  command.set_rig(rig);
  return call<v1::TareResponse>(command);
}

Result<v1::ListKeysResponse> ControlClient::list_keys() { return call<v1::ListKeysResponse>(v1::ListKeysRequest()); }

Result<v1::ListKeysResponse> ControlClient::add_key(const v1::AddKeyRequest& command) { return call<v1::ListKeysResponse>(command); }

Result<v1::ListKeysResponse> ControlClient::revoke_key(const std::string& name) {
  v1::RevokeKeyRequest command;
  command.set_name(name);
  return call<v1::ListKeysResponse>(command);
}

}  // namespace dts::client
