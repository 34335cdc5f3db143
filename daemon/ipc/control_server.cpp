// SPDX-License-Identifier: Apache-2.0
#include "ipc/control_server.h"

#include <algorithm>
#include <array>
#include <utility>

#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

constexpr std::int64_t kLongestRequestBytes = 16 * 1024;  // our largest is under 1 kB
constexpr std::size_t kLongestRequestId = 64;
constexpr std::size_t kMostFrames = 3;  // identity, delimiter, request
constexpr std::size_t kRepliesKept = 256;
constexpr int kRequestsPerTurn = 32;  // then sessions and devices get their turn
constexpr std::size_t kMostWaiting = 64;
constexpr std::int64_t kPendingTimeoutNs = 10'000'000'000;
constexpr std::int64_t kTickNs = 50'000'000;
constexpr std::int64_t kStatusNs = 1'000'000'000;
constexpr int kHandshakeMs = 2000;
constexpr int kQueueMessages = 100;

/// Commands that change something are remembered by id; looking twice does no harm.
bool is_repeatable(const dts::v1::Request& request) {
  switch (request.command_case()) {
    case dts::v1::Request::kStartSession:
    case dts::v1::Request::kStopSession:
    case dts::v1::Request::kMark:
    case dts::v1::Request::kTrial:
    case dts::v1::Request::kResumeSession:
    case dts::v1::Request::kTare: return false;
    default: return true;
  }
}

}  // namespace

core::Result<std::unique_ptr<ControlServer>> ControlServer::bind(zmq::context_t& context, const std::string& endpoint,
                                                                 session::Supervisor& supervisor, CommandHandler& handler,
                                                                 PublishThread& publisher, core::Clock& clock, std::uint64_t instance_id) {
  if (auto valid = check_endpoint(endpoint); !valid) return tl::make_unexpected(valid.error());
  if (auto free = check_not_in_use(endpoint); !free) return tl::make_unexpected(free.error());
  try {
    zmq::socket_t socket(context, zmq::socket_type::router);
    socket.set(zmq::sockopt::linger, 200);  // the last answers still get out at shutdown
    socket.set(zmq::sockopt::maxmsgsize, kLongestRequestBytes);
    socket.set(zmq::sockopt::rcvhwm, kQueueMessages);
    socket.set(zmq::sockopt::sndhwm, kQueueMessages);
    socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    socket.bind(endpoint);
    return std::unique_ptr<ControlServer>(new ControlServer(std::move(socket), supervisor, handler, publisher, clock, instance_id));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "control socket " + endpoint + " cannot be bound");
  }
}

ControlServer::ControlServer(zmq::socket_t socket, session::Supervisor& supervisor, CommandHandler& handler, PublishThread& publisher,
                             core::Clock& clock, std::uint64_t instance_id)
    : socket_(std::move(socket)),
      supervisor_(supervisor),
      handler_(handler),
      publisher_(publisher),
      clock_(clock),
      instance_id_(instance_id),
      replies_(kRepliesKept) {}

void ControlServer::serve(int ms) {
  const std::int64_t until_ns = clock_.now_ns() + ms * core::kNanosecondsPerMillisecond;
  for (std::int64_t now_ns = clock_.now_ns(); now_ns < until_ns; now_ns = clock_.now_ns()) {
    if (now_ns >= next_tick_ns_) {
      supervisor_.tick();
      publish_notices();
      answer_waiting();
      if (now_ns >= next_status_ns_) publish_status();
      next_tick_ns_ = now_ns + kTickNs;
    }
    const std::int64_t sleep_ns = std::min(until_ns, next_tick_ns_) - clock_.now_ns();
    zmq::pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
    zmq_poll(&item, 1, static_cast<long>(std::max<std::int64_t>(0, sleep_ns / core::kNanosecondsPerMillisecond + 1)));
    receive();
  }
}

void ControlServer::receive() {
  for (int turn = 0; turn < kRequestsPerTurn; ++turn) {
    std::vector<std::string> frames;
    bool is_too_long = false;
    bool has_more = true;
    while (has_more) {
      zmq::message_t frame;
      if (!socket_.recv(frame, zmq::recv_flags::dontwait)) return;  // parts of a message arrive together: only the first can be absent
      has_more = frame.more();
      is_too_long = is_too_long || frames.size() == kMostFrames;
      if (!is_too_long) frames.push_back(frame.to_string());
    }
    const bool has_delimiter = frames.size() == 3 && frames[1].empty();
    if (is_too_long || (frames.size() != 2 && !has_delimiter)) {
      frames.resize(1);
      reject(frames, "a request is one frame, or an empty one and then one");
      continue;
    }
    const std::string payload = std::move(frames.back());
    frames.pop_back();
    answer(std::move(frames), payload);
  }
}

void ControlServer::answer(std::vector<std::string> envelope, const std::string& payload) {
  dts::v1::Request request;
  if (!request.ParseFromString(payload)) return reject(envelope, "the message is not a dts.v1.Request");
  const std::string& id = request.request_id();
  if (id.empty() || id.size() > kLongestRequestId) return reject(envelope, "request_id must have 1..64 bytes");
  if (!is_repeatable(request) && answer_repeat(envelope, id, payload)) return;
  if ((request.has_tare() || request.has_stop_session()) && waiting_.size() == kMostWaiting) {
    return reject(envelope, "too many commands are being waited for");
  }
  CommandHandler::Answer result = handler_.execute(request);
  if (result.pending) {
    waiting_.push_back({.envelope = std::move(envelope),
                        .request_id = request.request_id(),
                        .payload = payload,
                        .request = std::move(request),
                        .pending = *result.pending,
                        .deadline_ns = clock_.now_ns() + kPendingTimeoutNs});
    return;
  }
  handler_.enter_audit(request, result.response);
  std::string bytes = result.response.SerializeAsString();
  reply(envelope, bytes);
  if (!is_repeatable(request)) replies_.store(id, {.request = payload, .reply = std::move(bytes)});
  publish_notices();
}

bool ControlServer::answer_repeat(std::vector<std::string>& envelope, const std::string& id, const std::string& payload) {
  const auto refuse = [&] { reject(envelope, "request_id was used for another request; it must be unique per command"); };
  if (const ReplyCache::Entry* known = replies_.find(id)) {
    if (known->request == payload) {
      reply(envelope, known->reply);
    } else {
      refuse();
    }
    return true;
  }
  const auto same = std::ranges::find(waiting_, id, &Waiting::request_id);
  if (same == waiting_.end()) return false;
  if (same->payload == payload) {
    same->envelope = std::move(envelope);  // the answer in the making goes to whoever asked last
  } else {
    refuse();
  }
  return true;
}

void ControlServer::answer_waiting() {
  std::erase_if(waiting_, [this](const Waiting& waiting) {
    auto response = handler_.finish(waiting.pending);
    if (!response && clock_.now_ns() > waiting.deadline_ns) response = handler_.give_up(waiting.pending);
    if (!response) return false;
    handler_.enter_audit(waiting.request, *response);
    response->set_request_id(waiting.request_id);
    std::string bytes = response->SerializeAsString();
    reply(waiting.envelope, bytes);
    replies_.store(waiting.request_id, {.request = waiting.payload, .reply = std::move(bytes)});
    return true;
  });
}

void ControlServer::reply(const std::vector<std::string>& envelope, const std::string& bytes) {
  try {
    for (const std::string& frame : envelope) socket_.send(zmq::buffer(frame), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
    socket_.send(zmq::buffer(bytes), zmq::send_flags::dontwait);
  } catch (const zmq::error_t&) {
    // The client left or does not read: it asks again if it still wants to know.
  }
}

void ControlServer::reject(const std::vector<std::string>& envelope, const std::string& why) {
  handler_.count_rejected();
  reply(envelope, error_response({core::ErrorCode::InvalidArgument, why, "client and daemon may differ in version"}).SerializeAsString());
}

void ControlServer::publish_notices() {
  for (const session::Notice& notice : supervisor_.take_notices()) {
    std::string name;
    auto event = std::make_unique<dts::v1::Event>(notice_event(instance_id_, notice, name));
    // Where things stand is repeated for newcomers; a marker is news only once.
    const bool is_state = name == "session" || name == "device";
    publisher_.post(notice.rig + "/" + name, std::move(event), is_state);
    next_status_ns_ = 0;
  }
}

void ControlServer::publish_status() {
  publisher_.post("dtsd/status", std::make_unique<dts::v1::StatusSnapshot>(handler_.status()), true);
  next_status_ns_ = clock_.now_ns() + kStatusNs;
}

}  // namespace dts::ipc
