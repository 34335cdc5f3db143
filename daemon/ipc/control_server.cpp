// SPDX-License-Identifier: Apache-2.0
#include "ipc/control_server.h"

#include <algorithm>
#include <string>
#include <utility>

#include "dts/wire/options.h"
#include "ipc/audit_trail.h"

namespace dts::ipc {
namespace {

constexpr std::size_t kLongestRequestId = 64;
constexpr std::size_t kRepliesKept = 256;
constexpr int kRequestsPerTurn = 32;  // then sessions and devices are served
constexpr std::size_t kMostWaiting = 64;
constexpr std::int64_t kPendingTimeoutNs = 10'000'000'000;
constexpr std::int64_t kTickNs = 50'000'000;
constexpr std::int64_t kStatusNs = 1'000'000'000;
constexpr std::int64_t kLogNs = 1'000'000'000;  // at most one log line for rejected requests in this time

/// Returns the key for the reply cache. It includes the sender, so that two senders can use the same request ID and never get each other's
/// answer.
std::string known_as(const access::Peer& peer, const std::string& request_id) { return peer.who + '\n' + request_id; }

}  // namespace

ControlServer::ControlServer(ControlSocket socket, access::Gate gate, session::Supervisor& supervisor, CommandHandler& handler,
                             PublishThread& publisher, core::Clock& clock, core::Log log)
    : socket_(std::move(socket)),
      gate_(std::move(gate)),
      supervisor_(supervisor),
      handler_(handler),
      publisher_(publisher),
      clock_(clock),
      log_(std::move(log)),
      replies_(kRepliesKept) {}

void ControlServer::serve(int ms) {
  zmq::pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
  const std::int64_t until_ns = clock_.now_ns() + ms * core::kNanosecondsPerMillisecond;
  for (std::int64_t now_ns = clock_.now_ns(); now_ns < until_ns; now_ns = clock_.now_ns()) {
    if (now_ns >= next_tick_ns_) {
      supervisor_.tick();
      publish_notices();
      answer_waiting();
      if (now_ns >= next_status_ns_) publish_status();
      log_rejected(now_ns);
      next_tick_ns_ = now_ns + kTickNs;
    }
    const std::int64_t sleep_ns = std::min(until_ns, next_tick_ns_) - clock_.now_ns();
    zmq_poll(&item, 1, static_cast<long>(std::max<std::int64_t>(0, sleep_ns / core::kNanosecondsPerMillisecond + 1)));
    receive();
  }
}

void ControlServer::receive() {
  for (int turn = 0; turn < kRequestsPerTurn; ++turn) {
    auto incoming = socket_.receive();
    if (!incoming) return;
    answer(std::move(*incoming));
  }
}

void ControlServer::answer(Incoming asked) {
  access::Peer peer = asked.public_key ? gate_.remote(*asked.public_key) : access::Gate::local();
  if (!asked.is_well_formed) return reject(asked, peer, "a request must be one frame, or an empty frame and then one frame");
  dts::v1::Request request;
  if (!request.ParseFromString(asked.payload)) return reject(asked, peer, "the message is not a dts.v1.Request");
  const std::string id = request.request_id();
  if (id.empty() || id.size() > kLongestRequestId) return reject(asked, peer, "request_id must have 1..64 bytes");
  if (auto allowed = access::Gate::check(peer, request); !allowed) return refuse(asked, peer, request, allowed.error());
  const dts::v1::CommandRules& rules = wire::rules_of(request);
  if (rules.is_change() && answer_repeat(asked, peer, id)) return;
  if (rules.timeout_s() > 0 && waiting_.size() == kMostWaiting) {
    return reject(asked, peer, "too many commands wait for their answers");
  }
  CommandHandler::Answer result = handler_.execute(request, author_of(peer.who, request));
  if (result.pending) {
    waiting_.push_back({.asked = std::move(asked),
                        .peer = std::move(peer),
                        .request = std::move(request),
                        .pending = *result.pending,
                        .deadline_ns = clock_.now_ns() + kPendingTimeoutNs});
    return;
  }
  enter_audit(peer, request, result.response);
  std::string bytes = result.response.SerializeAsString();
  socket_.reply(asked.envelope, bytes);
  if (rules.is_change()) replies_.store(known_as(peer, id), {.request = std::move(asked.payload), .reply = std::move(bytes)});
  publish_notices();
}

bool ControlServer::answer_repeat(Incoming& asked, const access::Peer& peer, const std::string& id) {
  const auto refuse_id = [&] { reject(asked, peer, "request_id was used for another request; it must be unique per command"); };
  if (const ReplyCache::Entry* known = replies_.find(known_as(peer, id))) {
    if (known->request == asked.payload) {
      socket_.reply(asked.envelope, known->reply);
    } else {
      refuse_id();
    }
    return true;
  }
  const auto same = std::ranges::find_if(
      waiting_, [&](const Waiting& waiting) { return waiting.request.request_id() == id && waiting.peer.who == peer.who; });
  if (same == waiting_.end()) return false;
  if (same->asked.payload == asked.payload) {
    same->asked.envelope = std::move(asked.envelope);  // only the latest repeat gets the answer
  } else {
    refuse_id();
  }
  return true;
}

void ControlServer::answer_waiting() {
  std::erase_if(waiting_, [this](Waiting& waiting) {
    auto response = handler_.finish(waiting.pending);
    if (!response && clock_.now_ns() > waiting.deadline_ns) response = handler_.give_up(waiting.pending);
    if (!response) return false;
    enter_audit(waiting.peer, waiting.request, *response);
    response->set_request_id(waiting.request.request_id());
    std::string bytes = response->SerializeAsString();
    socket_.reply(waiting.asked.envelope, bytes);
    replies_.store(known_as(waiting.peer, waiting.request.request_id()),
                   {.request = std::move(waiting.asked.payload), .reply = std::move(bytes)});
    return true;
  });
}

void ControlServer::refuse(const Incoming& asked, const access::Peer& peer, const dts::v1::Request& request, const core::Error& why) {
  dts::v1::Response response = error_response(why);
  response.set_request_id(request.request_id());
  socket_.reply(asked.envelope, response.SerializeAsString());
  enter_audit(peer, request, response);
}

/// Limits the entries of failed commands: each entry is a write to the disk, and a flood must not fill the disk or keep this thread busy.
void ControlServer::enter_audit(const access::Peer& peer, const dts::v1::Request& request, const dts::v1::Response& response) {
  if (!is_audited(request, response)) return;
  if (response.has_error() && !gate_.is_worth_a_note(peer, clock_.now_ns())) return;
  ipc::enter_audit(supervisor_, clock_, peer.who, request, response);
}

void ControlServer::log_rejected(std::int64_t now_ns) {
  if (unlogged_rejections_ == 0 || now_ns < next_log_ns_) return;
  log_.warning("rejected " + std::to_string(std::exchange(unlogged_rejections_, 0)) + " malformed requests, the last by " + last_rejected_);
  next_log_ns_ = now_ns + kLogNs;
}

void ControlServer::reject(const Incoming& asked, const access::Peer& peer, const std::string& why) {
  handler_.count_rejected();
  ++unlogged_rejections_;
  last_rejected_ = peer.who;
  socket_.reply(asked.envelope,
                error_response({core::ErrorCode::InvalidArgument, why, "compare the versions of client and daemon: dtsctl doctor"})
                    .SerializeAsString());
}

void ControlServer::publish_notices() {
  for (session::Notice& notice : supervisor_.take_notices()) {
    publisher_.post(notice.rig, std::move(notice.event));
    next_status_ns_ = 0;
  }
}

void ControlServer::publish_status() {
  publisher_.post(handler_.status());
  next_status_ns_ = clock_.now_ns() + kStatusNs;
}

}  // namespace dts::ipc
