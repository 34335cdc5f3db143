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
#include "wire_check.h"

namespace dts::client {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t kAnswerSocketBytes = 4 * static_cast<std::int64_t>(kMaxAnswerBytes);
constexpr std::size_t kLongestText = 2000;
constexpr milliseconds kLookForStop{50};

/// 128 random bits: no two commands of any client share it.
std::string new_request_id() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string id;
  for (int digit = 0; digit < 32; ++digit) id += kDigits[random() % kDigits.size()];
  return id;
}

/// The same bytes for the same request: of a repeat the daemon compares them with those it knows, and maps have no order otherwise.
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
  std::string what = wire.what().empty() ? "the daemon refused and gave no reason" : wire.what().substr(0, kLongestText);
  return {code, std::move(what), wire.hint().substr(0, kLongestText)};
}

Result<void> check_options(const ControlOptions& options) {
  constexpr milliseconds kShortest{30};
  constexpr milliseconds kLongest{std::chrono::hours(24)};
  if (options.endpoint.empty()) {
    return fail(ErrorCode::InvalidArgument, "the daemon's control address is not known", "give it: --endpoint URI or DTSD_CONTROL");
  }
  const auto [shortest, longest] = std::minmax({options.timeout, options.tare_timeout, options.stop_timeout});
  if (shortest < kShortest || longest > kLongest) {
    return fail(ErrorCode::InvalidArgument, "a time-out must be between 0.03 and 86400 seconds");
  }
  if (options.tries < 1 || options.tries > 10) return fail(ErrorCode::InvalidArgument, "tries must be 1..10");
  return {};
}

std::string seconds(milliseconds time) {
  const std::string tenths = std::to_string((time.count() + 50) / 100 % 10);
  return std::to_string((time.count() + 50) / 1000) + "." + tenths + " s";
}

}  // namespace

class ControlClient::Implementation {
 public:
  explicit Implementation(ControlOptions options) : options_(std::move(options)) {}

  /// Fills in the request id when there is none, sends, waits; fails unless the answer has `wanted`.
  Result<v1::Response> exchange(v1::Request&& request, v1::Response::ResultCase wanted, milliseconds timeout, const std::stop_token& stop);

  [[nodiscard]] const ControlOptions& options() const noexcept { return options_; }
  [[nodiscard]] std::uint64_t ignored_replies() const noexcept { return ignored_replies_; }

 private:
  void reopen();
  void send(const std::string& request);
  [[nodiscard]] std::optional<v1::Response> wait_for(const std::string& request_id, Clock::time_point deadline,
                                                     const std::stop_token& stop);
  [[nodiscard]] std::optional<v1::Response> take(const std::string& request_id);
  [[nodiscard]] tl::unexpected<Error> unreachable(milliseconds timeout, std::uint64_t ignored) const;

  ControlOptions options_;
  zmq::context_t context_{1};
  zmq::socket_t socket_;
  std::uint64_t ignored_replies_ = 0;
};

Result<v1::Response> ControlClient::Implementation::exchange(v1::Request&& request, v1::Response::ResultCase wanted, milliseconds timeout,
                                                             const std::stop_token& stop) {
  if (auto somebody = probe(options_.endpoint); !somebody) return tl::make_unexpected(somebody.error());
  if (request.request_id().empty()) request.set_request_id(new_request_id());
  const std::string bytes = bytes_of(request);
  // Serialising lets text through that no peer can parse; such a request would never be answered.
  if (v1::Request echo; !echo.ParseFromString(bytes)) return fail(ErrorCode::InvalidArgument, "the text is not valid UTF-8");
  const std::uint64_t ignored_before = ignored_replies_;
  for (int attempt = 0; attempt < options_.tries; ++attempt) {
    if (attempt > 0 || !socket_) reopen();
    send(bytes);
    auto response = wait_for(request.request_id(), Clock::now() + timeout / options_.tries, stop);
    if (stop.stop_requested()) return fail(ErrorCode::Failed, "the answer is not waited for any more: this program ends");
    if (!response) continue;
    if (response->has_error()) return tl::make_unexpected(to_error(response->error()));
    if (response->result_case() == wanted) return std::move(*response);
    return fail(ErrorCode::DataDamaged, "the daemon's answer does not belong to the command",
                "are dtsd and this program of the same version?");
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

/// In the envelope of a REQ socket (an empty frame first): every ROUTER that serves REQ understands it.
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
    // A signal ends the wait early; the deadline decides whether to go on.
    zmq_poll(&item, 1, static_cast<long>(turn.count()));
    if (auto response = take(request_id)) return response;
  }
  return std::nullopt;
}

/// One message; nothing, and counted, when it is not the answer to `request_id`.
std::optional<v1::Response> ControlClient::Implementation::take(const std::string& request_id) {
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
  // A daemon that cannot read a request refuses it without its id.
  const bool is_refusal = is_response && response.request_id().empty() && response.has_error();
  if (is_response && (response.request_id() == request_id || is_refusal)) return response;
  ++ignored_replies_;
  return std::nullopt;
}

tl::unexpected<Error> ControlClient::Implementation::unreachable(milliseconds timeout, std::uint64_t ignored) const {
  const std::string where = options_.endpoint + " within " + seconds(timeout) + " (" + std::to_string(options_.tries) + " tries)";
  if (ignored > 0) {
    return fail(ErrorCode::Unreachable, "no proper answer from " + where + "; " + std::to_string(ignored) + " messages came that are none",
                "is it dtsd that listens there? check --endpoint; compare the versions");
  }
  if (options_.key) {
    return fail(ErrorCode::Unreachable, "no answer from " + where,
                "is dtsd running there, does it listen ([network] of its configuration), and does it know the key '" + options_.key->name +
                    "'? ask there: dtsctl key list");
  }
  return fail(ErrorCode::Unreachable, "no answer from " + where,
              "is dtsd running? systemctl status dtsd; is the address right? give --endpoint");
}

Result<ControlClient> ControlClient::open(const ControlOptions& options) {
  if (auto valid = check_options(options); !valid) return tl::make_unexpected(valid.error());
  return ControlClient(std::make_unique<Implementation>(options));
}

ControlClient::ControlClient(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
ControlClient::~ControlClient() = default;
ControlClient::ControlClient(ControlClient&&) noexcept = default;
ControlClient& ControlClient::operator=(ControlClient&&) noexcept = default;
std::uint64_t ControlClient::ignored_replies() const noexcept { return implementation_->ignored_replies(); }

namespace {

template <class Client>
Result<v1::Response> exchange(Client& client, v1::Request&& request, v1::Response::ResultCase wanted, milliseconds timeout,
                              const std::stop_token& stop = {}) {
  try {
    return client.exchange(std::move(request), wanted, timeout, stop);
  } catch (const zmq::error_t& error) {
    const bool is_address = error.num() == EINVAL || error.num() == EPROTONOSUPPORT || error.num() == ENODEV;
    return fail(is_address ? ErrorCode::InvalidArgument : ErrorCode::Internal,
                "cannot use the control address '" + client.options().endpoint + "': " + error.what());
  }
}

/// Runs one command and takes the checked payload out of its answer.
template <class Payload, class Client>
Result<Payload> call(Client& client, v1::Request&& request, v1::Response::ResultCase wanted, Payload* (v1::Response::*mutable_payload)(),
                     milliseconds timeout) {
  auto response = exchange(client, std::move(request), wanted, timeout);
  if (!response) return tl::make_unexpected(response.error());
  Payload payload = std::move(*((*response).*mutable_payload)());
  if (auto valid = check(payload); !valid) return tl::make_unexpected(valid.error());
  return payload;
}

/// What answers a command, and how long that may take.
struct Expectation {
  v1::Response::ResultCase answer = v1::Response::RESULT_NOT_SET;
  milliseconds timeout{};
};

Expectation expectation(const v1::Request& request, const ControlOptions& options) {
  switch (request.command_case()) {
    case v1::Request::kStatus: return {v1::Response::kStatus, options.timeout};
    case v1::Request::kListRigs: return {v1::Response::kRigs, options.timeout};
    case v1::Request::kStartSession:
    case v1::Request::kResumeSession: return {v1::Response::kSession, options.timeout};
    case v1::Request::kStopSession: return {v1::Response::kSession, options.stop_timeout};
    case v1::Request::kMark: return {v1::Response::kMark, options.timeout};
    case v1::Request::kTare: return {v1::Response::kTare, options.tare_timeout};
    case v1::Request::kGetDevices: return {v1::Response::kDevices, options.timeout};
    case v1::Request::kTestDevice: return {v1::Response::kDeviceTest, options.timeout};
    case v1::Request::kListSessions: return {v1::Response::kSessions, options.timeout};
    case v1::Request::kShowSession: return {v1::Response::kSessionRecord, options.timeout};
    case v1::Request::kListProtocols: return {v1::Response::kProtocols, options.timeout};
    case v1::Request::kTrial: return {v1::Response::kTrial, options.timeout};
    case v1::Request::kGetAudit: return {v1::Response::kAudit, options.timeout};
    case v1::Request::kListKeys:
    case v1::Request::kAddKey:
    case v1::Request::kRevokeKey: return {v1::Response::kKeys, options.timeout};
    case v1::Request::kNoteLogin: return {v1::Response::kNoteLogin, options.timeout};
    case v1::Request::COMMAND_NOT_SET: break;
  }
  return {};
}

}  // namespace

Result<v1::Response> ControlClient::forward(const v1::Request& request, const std::stop_token& stop) {
  const Expectation expected = expectation(request, implementation_->options());
  if (expected.answer == v1::Response::RESULT_NOT_SET) {
    return fail(ErrorCode::InvalidArgument, "a request without a command, or with one that this version does not know");
  }
  auto response = exchange(*implementation_, v1::Request(request), expected.answer, expected.timeout, stop);
  if (!response) return response;
  if (auto valid = check(*response); !valid) return tl::make_unexpected(valid.error());
  return response;
}

Result<v1::ListKeysResponse> ControlClient::list_keys() {
  v1::Request request;
  request.mutable_list_keys();
  return call(*implementation_, std::move(request), v1::Response::kKeys, &v1::Response::mutable_keys, implementation_->options().timeout);
}

Result<v1::ListKeysResponse> ControlClient::add_key(const v1::AddKeyRequest& wanted) {
  v1::Request request;
  *request.mutable_add_key() = wanted;
  return call(*implementation_, std::move(request), v1::Response::kKeys, &v1::Response::mutable_keys, implementation_->options().timeout);
}

Result<v1::ListKeysResponse> ControlClient::revoke_key(const std::string& name) {
  v1::Request request;
  request.mutable_revoke_key()->set_name(name);
  return call(*implementation_, std::move(request), v1::Response::kKeys, &v1::Response::mutable_keys, implementation_->options().timeout);
}

Result<v1::StatusSnapshot> ControlClient::status() {
  v1::Request request;
  request.mutable_status();
  return call(*implementation_, std::move(request), v1::Response::kStatus, &v1::Response::mutable_status,
              implementation_->options().timeout);
}

Result<v1::ListRigsResponse> ControlClient::list_rigs() {
  v1::Request request;
  request.mutable_list_rigs();
  return call(*implementation_, std::move(request), v1::Response::kRigs, &v1::Response::mutable_rigs, implementation_->options().timeout);
}

Result<v1::GetDevicesResponse> ControlClient::devices() {
  v1::Request request;
  request.mutable_get_devices();
  return call(*implementation_, std::move(request), v1::Response::kDevices, &v1::Response::mutable_devices,
              implementation_->options().timeout);
}

Result<v1::TestDeviceResponse> ControlClient::test_device(const std::string& rig) {
  v1::Request request;
  request.mutable_test_device()->set_rig(rig);
  return call(*implementation_, std::move(request), v1::Response::kDeviceTest, &v1::Response::mutable_device_test,
              implementation_->options().timeout);
}

Result<v1::SessionInfo> ControlClient::start_session(const v1::StartSessionRequest& wanted) {
  v1::Request request;
  *request.mutable_start_session() = wanted;
  return call(*implementation_, std::move(request), v1::Response::kSession, &v1::Response::mutable_session,
              implementation_->options().timeout);
}

Result<v1::SessionInfo> ControlClient::stop_session(const std::string& rig) {
  v1::StopSessionRequest wanted;
  wanted.set_rig(rig);
  return stop_session(wanted);
}

Result<v1::SessionInfo> ControlClient::stop_session(const v1::StopSessionRequest& wanted) {
  v1::Request request;
  *request.mutable_stop_session() = wanted;
  return call(*implementation_, std::move(request), v1::Response::kSession, &v1::Response::mutable_session,
              implementation_->options().stop_timeout);
}

Result<v1::SessionInfo> ControlClient::resume_session(const std::string& session_id) {
  v1::Request request;
  request.mutable_resume_session()->set_session_id(session_id);
  return call(*implementation_, std::move(request), v1::Response::kSession, &v1::Response::mutable_session,
              implementation_->options().timeout);
}

Result<v1::TrialStatus> ControlClient::trial(v1::TrialAction action, const std::string& rig) {
  v1::Request request;
  request.mutable_trial()->set_action(action);
  request.mutable_trial()->set_rig(rig);
  return call(*implementation_, std::move(request), v1::Response::kTrial, &v1::Response::mutable_trial, implementation_->options().timeout);
}

Result<v1::ListSessionsResponse> ControlClient::list_sessions(const v1::ListSessionsRequest& wanted) {
  v1::Request request;
  *request.mutable_list_sessions() = wanted;
  return call(*implementation_, std::move(request), v1::Response::kSessions, &v1::Response::mutable_sessions,
              implementation_->options().timeout);
}

Result<v1::SessionRecord> ControlClient::show_session(const std::string& session_id) {
  v1::Request request;
  request.mutable_show_session()->set_session_id(session_id);
  return call(*implementation_, std::move(request), v1::Response::kSessionRecord, &v1::Response::mutable_session_record,
              implementation_->options().timeout);
}

Result<v1::ListProtocolsResponse> ControlClient::list_protocols() {
  v1::Request request;
  request.mutable_list_protocols();
  return call(*implementation_, std::move(request), v1::Response::kProtocols, &v1::Response::mutable_protocols,
              implementation_->options().timeout);
}

Result<v1::GetAuditResponse> ControlClient::audit(std::uint32_t limit) {
  v1::Request request;
  request.mutable_get_audit()->set_limit(limit);
  return call(*implementation_, std::move(request), v1::Response::kAudit, &v1::Response::mutable_audit, implementation_->options().timeout);
}

Result<v1::MarkResponse> ControlClient::mark(const std::string& text, const std::string& rig) {
  v1::Request request;
  request.mutable_mark()->set_text(text);
  request.mutable_mark()->set_rig(rig);
  return call(*implementation_, std::move(request), v1::Response::kMark, &v1::Response::mutable_mark, implementation_->options().timeout);
}

Result<v1::TareResponse> ControlClient::tare(const std::string& rig) {
  v1::Request request;
  request.mutable_tare()->set_rig(rig);
  return call(*implementation_, std::move(request), v1::Response::kTare, &v1::Response::mutable_tare,
              implementation_->options().tare_timeout);
}

}  // namespace dts::client
