// SPDX-License-Identifier: Apache-2.0
#include "ipc/xpub_socket.h"

#include <poll.h>

#include <array>

#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

// 256 would be enough for our topics, but the limit also applies to CURVE handshakes, whose largest frame is longer.
constexpr int kLongestSubscriptionBytes = 512;
// Limited, because handling a flood of subscription messages at once would stop publishing.
constexpr int kSubscriptionsPerTurn = 64;

}  // namespace

core::Result<std::unique_ptr<XpubSocket>> XpubSocket::bind(zmq::context_t& context, const std::string& endpoint, int queue_messages,
                                                           const std::optional<RemoteEndpoint>& remote) {
  if (!endpoint.empty()) {
    DTS_TRY(check_endpoint(endpoint));
    DTS_TRY(check_not_in_use(endpoint));
  }
  if (remote) {
    DTS_TRY(check_remote_endpoint(remote->endpoint));
  }
  std::string trying = endpoint;
  try {
    zmq::socket_t socket(context, zmq::socket_type::xpub);
    socket.set(zmq::sockopt::linger, 200);  // time to send the last events at shutdown
    socket.set(zmq::sockopt::sndhwm, queue_messages);
    socket.set(zmq::sockopt::maxmsgsize, std::int64_t{kLongestSubscriptionBytes});
    socket.set(zmq::sockopt::xpub_verbose, true);  // reports every subscription, so that each subscriber gets the retained messages
    socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    use_local_thread(socket);
    if (!endpoint.empty()) socket.bind(endpoint);
    std::string bound;
    if (remote) {
      trying = remote->endpoint;
      bound = bind_remote(socket, *remote);
    }
    return std::unique_ptr<XpubSocket>(new XpubSocket(std::move(socket), std::move(bound)));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "data socket " + trying + " cannot be bound", bind_hint(error.num()));
  }
}

void XpubSocket::send(std::string_view topic, const google::protobuf::MessageLite& message) {
  try {
    zmq::message_t payload(message.ByteSizeLong());
    message.SerializeWithCachedSizesToArray(static_cast<std::uint8_t*>(payload.data()));
    socket_.send(zmq::buffer(topic), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
    socket_.send(payload, zmq::send_flags::dontwait);
  } catch (const zmq::error_t&) {
    // An XPUB send fails only while the context is being destroyed.
  }
}

bool XpubSocket::has_input() {
  int events = 0;
  std::size_t size = sizeof events;
  return zmq_getsockopt(socket_.handle(), ZMQ_EVENTS, &events, &size) == 0 && (events & ZMQ_POLLIN) != 0;
}

// Does not use zmq_poll, which checks the socket several times per turn with two system calls each, and every frame needs a turn. The
// socket's descriptor is edge-triggered (zmq_getsockopt(3), ZMQ_FD), and a send may have consumed the edge: so check the socket before
// sleeping.
void XpubSocket::wait(int bell_fd, int timeout_ms) {
  if (look()) return;
  std::array<pollfd, 2> waited{{{.fd = socket_fd_, .events = POLLIN, .revents = 0}, {.fd = bell_fd, .events = POLLIN, .revents = 0}}};
  ::poll(waited.data(), waited.size(), timeout_ms);
  has_input_ = waited.front().revents != 0;
}

bool XpubSocket::take_subscriptions() {
  if (!has_input_) return false;
  bool has_new = false;
  for (int turn = 0; turn < kSubscriptionsPerTurn; ++turn) {
    zmq::message_t message;
    if (!socket_.recv(message, zmq::recv_flags::dontwait)) break;
    // XPUB receives "\1<topic>" for a subscription and "\0<topic>" for its end. Ignore all other messages.
    if (message.size() >= 1 && *message.data<char>() == 1) has_new = true;
  }
  return has_new;
}

}  // namespace dts::ipc
