// SPDX-License-Identifier: Apache-2.0
#include "ipc/xpub_socket.h"

#include <array>

#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

// 256 would do for our topics, but admits nobody once CURVE handshakes (their largest frame is bigger).
constexpr int kLongestSubscriptionBytes = 512;
// Draining all subscription messages at once would silence the publisher during a flood of them.
constexpr int kSubscriptionsPerTurn = 64;
constexpr int kHandshakeMs = 2000;
constexpr int kHeartbeatMs = 1000;
constexpr int kHeartbeatTimeoutMs = 5000;

}  // namespace

core::Result<std::unique_ptr<XpubSocket>> XpubSocket::bind(zmq::context_t& context, const std::string& endpoint, int queue_messages) {
  if (auto valid = check_endpoint(endpoint); !valid) return tl::make_unexpected(valid.error());
  if (auto free = check_not_in_use(endpoint); !free) return tl::make_unexpected(free.error());
  try {
    zmq::socket_t socket(context, zmq::socket_type::xpub);
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::sndhwm, queue_messages);
    socket.set(zmq::sockopt::maxmsgsize, std::int64_t{kLongestSubscriptionBytes});
    socket.set(zmq::sockopt::xpub_verbose, true);  // a second subscriber to a topic wants its snapshot too
    socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    socket.set(zmq::sockopt::heartbeat_ivl, kHeartbeatMs);
    socket.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeoutMs);
    socket.bind(endpoint);
    return std::unique_ptr<XpubSocket>(new XpubSocket(std::move(socket)));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "data socket " + endpoint + " cannot be bound");
  }
}

void XpubSocket::send(std::string_view topic, const google::protobuf::MessageLite& message) {
  try {
    zmq::message_t payload(message.ByteSizeLong());
    message.SerializeWithCachedSizesToArray(static_cast<std::uint8_t*>(payload.data()));
    socket_.send(zmq::buffer(topic), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
    socket_.send(payload, zmq::send_flags::dontwait);
  } catch (const zmq::error_t&) {
    // Only a context being torn down fails an XPUB send; the next wait() ends the loop.
  }
}

void XpubSocket::wait(int bell_fd, int timeout_ms) {
  std::array<zmq::pollitem_t, 2> items{{{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0},
                                        {.socket = nullptr, .fd = bell_fd, .events = ZMQ_POLLIN, .revents = 0}}};
  zmq_poll(items.data(), static_cast<int>(items.size()), timeout_ms);
}

bool XpubSocket::take_subscriptions() {
  bool has_new = false;
  for (int turn = 0; turn < kSubscriptionsPerTurn; ++turn) {
    zmq::message_t message;
    if (!socket_.recv(message, zmq::recv_flags::dontwait)) break;
    // XPUB hands up "\1<topic>" for a subscription and "\0<topic>" for its end; anything else is a stranger's message.
    if (message.size() >= 1 && *message.data<char>() == 1) has_new = true;
  }
  return has_new;
}

}  // namespace dts::ipc
