// SPDX-License-Identifier: Apache-2.0
#include "relay/control_relay.h"

#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "dts/v1/control.pb.h"
#include "relay/frames.h"

namespace dts::relay {
namespace {

constexpr std::int64_t kLongestRequestBytes = 4 * 1024;  // as dtsd's own control socket
constexpr int kQueueCommands = 400;                      // on their way to dtsd; answers on their way to one client
constexpr std::size_t kMostFrames = 4;                   // one more than any message has
constexpr int kReadPerTurn = 4096;
constexpr int kReconnectMs = 100;
constexpr std::int64_t kLogNs = 1'000'000'000;  // at most one log line for rejected requests in this time

// Last byte of a ticket.
constexpr char kPlain = '\0';
constexpr char kDelimited = '\1';

zmq::socket_t router(zmq::context_t& context) {
  zmq::socket_t socket(context, zmq::socket_type::router);
  socket.set(zmq::sockopt::linger, 200);  // time to send the last answers at shutdown
  socket.set(zmq::sockopt::maxmsgsize, kLongestRequestBytes);
  socket.set(zmq::sockopt::sndhwm, kQueueCommands);
  return socket;
}

zmq::socket_t dealer_to(zmq::context_t& context, const std::string& endpoint) {
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::immediate, true);  // while dtsd is away, a send fails, instead of filling a queue
  socket.set(zmq::sockopt::sndhwm, kQueueCommands);
  socket.set(zmq::sockopt::rcvhwm, kQueueCommands);
  socket.set(zmq::sockopt::reconnect_ivl, kReconnectMs);
  socket.connect(endpoint);
  return socket;
}

/// Sends a message without waiting; returns false if there is no room or nobody to receive it.
bool send(zmq::socket_t& socket, std::span<const std::string_view> frames) noexcept {
  for (std::size_t index = 0; index < frames.size(); ++index) {
    const int flags = ZMQ_DONTWAIT | (index + 1 < frames.size() ? ZMQ_SNDMORE : 0);
    if (zmq_send(socket.handle(), frames[index].data(), frames[index].size(), flags) < 0) return false;
  }
  return true;
}

}  // namespace

core::Result<ControlRelay> ControlRelay::open(zmq::context_t& context, const RemoteEndpoint& remote, const std::string& local,
                                              const access::KeyStore& keys, core::Clock& clock, core::Log log) {
  DTS_TRY_ASSIGN(auto listener, RemoteListener::bind(router(context), remote, "control"));
  try {
    return ControlRelay(std::move(listener), dealer_to(context, local), keys, clock, std::move(log));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "cannot use dtsd's control address " + local);
  }
}

void ControlRelay::serve(int ms) {
  std::array<zmq::pollitem_t, 2> items{{{.socket = listener_.socket().handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0},
                                        {.socket = dealer_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0}}};
  zmq_poll(items.data(), static_cast<int>(items.size()), ms);
  for (int turn = 0; turn < kReadPerTurn && pass_answer(); ++turn) continue;
  for (int turn = 0; turn < kReadPerTurn; ++turn) {
    const auto incoming = receive();
    if (!incoming) break;
    pass(*incoming);
  }
  log_rejected();
}

std::optional<ControlRelay::Incoming> ControlRelay::receive() {
  auto frames = receive_frames(listener_.socket(), kMostFrames);
  if (!frames) return std::nullopt;
  const char* name = zmq_msg_gets(frames->back().handle(), "User-Id");
  Incoming incoming{.client = frames->front().to_string(), .public_key = name == nullptr ? "" : name};
  incoming.has_delimiter = frames->size() == 3 && (*frames)[1].size() == 0;
  incoming.is_well_formed = frames->size() == 2 || incoming.has_delimiter;
  if (incoming.is_well_formed) incoming.request = frames->back().to_string();
  return incoming;
}

void ControlRelay::pass(const Incoming& incoming) {
  const std::string who = senders_.remote(incoming.public_key).who;
  if (auto admitted = limit_.admit(who, clock_.now_ns()); !admitted) {
    note_rejected(who);
    if (limit_.is_worth_an_answer(who, clock_.now_ns())) refuse(incoming, admitted.error());
  } else if (!incoming.is_well_formed) {
    note_rejected(who);
    refuse(incoming, {core::ErrorCode::InvalidArgument, "a request must be one frame, or an empty frame and then one frame",
                      "compare the versions of client and daemon: dtsctl doctor"});
  } else if (!forward(incoming)) {
    refuse(incoming, {core::ErrorCode::Unreachable, "dts-relay answers, but dtsd does not",
                      "on the daemon's machine, check that dtsd runs: systemctl status dtsd"});
  }
}

bool ControlRelay::forward(const Incoming& incoming) {
  const std::string ticket = incoming.client + (incoming.has_delimiter ? kDelimited : kPlain);
  return send(dealer_, std::array<std::string_view, 3>{ticket, incoming.public_key, incoming.request});
}

/// Returns false if no answer of dtsd waits.
bool ControlRelay::pass_answer() {
  const auto frames = receive_frames(dealer_, kMostFrames);
  if (!frames) return false;
  const std::string_view ticket = frames->front().to_string_view();
  if (frames->size() != 2 || ticket.empty()) return true;
  answer(ticket.substr(0, ticket.size() - 1), ticket.back() == kDelimited, frames->back().to_string_view());
  return true;
}

/// Sends without waiting. A client that has left or does not read loses the answer; it can repeat its request.
void ControlRelay::answer(std::string_view client, bool has_delimiter, std::string_view response) {
  const std::array<std::string_view, 3> frames{client, "", response};
  const std::array<std::string_view, 2> plain{client, response};
  static_cast<void>(has_delimiter ? send(listener_.socket(), frames) : send(listener_.socket(), plain));
}

/// Answers without request_id, because the request was not decoded.
void ControlRelay::refuse(const Incoming& incoming, const core::Error& error) {
  v1::Response response;
  response.mutable_error()->set_code(static_cast<v1::ErrorCode>(error.code));
  response.mutable_error()->set_what(error.what);
  response.mutable_error()->set_hint(error.hint);
  answer(incoming.client, incoming.has_delimiter, response.SerializeAsString());
}

void ControlRelay::note_rejected(const std::string& who) {
  ++unlogged_rejections_;
  last_rejected_ = who;
}

void ControlRelay::log_rejected() {
  const std::int64_t now_ns = clock_.now_ns();
  if (unlogged_rejections_ == 0 || now_ns < next_log_ns_) return;
  log_.warning("rejected " + std::to_string(std::exchange(unlogged_rejections_, 0)) + " malformed or excess requests, the last by " +
               last_rejected_);
  next_log_ns_ = now_ns + kLogNs;
}

}  // namespace dts::relay
