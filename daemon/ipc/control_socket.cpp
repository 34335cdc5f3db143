// SPDX-License-Identifier: Apache-2.0
#include "ipc/control_socket.h"

#include <utility>

#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

constexpr std::int64_t kLongestRequestBytes = 4 * 1024;  // our largest request has less than 1 kB
constexpr std::size_t kMostFrames = 3;                   // identity, delimiter, request
constexpr int kQueueMessages = 100;

zmq::socket_t router(zmq::context_t& context) {
  zmq::socket_t socket(context, zmq::socket_type::router);
  socket.set(zmq::sockopt::linger, 200);  // time to send the last answers at shutdown
  socket.set(zmq::sockopt::maxmsgsize, kLongestRequestBytes);
  socket.set(zmq::sockopt::rcvhwm, kQueueMessages);
  socket.set(zmq::sockopt::sndhwm, kQueueMessages);
  socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
  return socket;
}

}  // namespace

core::Result<ControlSocket> ControlSocket::bind(zmq::context_t& context, const std::string& endpoint) {
  DTS_TRY(check_endpoint(endpoint));
  DTS_TRY(check_not_in_use(endpoint));
  try {
    zmq::socket_t socket = router(context);
    use_local_thread(socket);
    socket.bind(endpoint);
    return ControlSocket(std::move(socket), "");
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "control socket " + endpoint + " cannot be bound", bind_hint(error.num()));
  }
}

core::Result<ControlSocket> ControlSocket::bind(zmq::context_t& context, const RemoteEndpoint& remote) {
  DTS_TRY(check_remote_endpoint(remote.endpoint));
  try {
    zmq::socket_t socket = router(context);
    std::string bound = bind_remote(socket, remote);
    return ControlSocket(std::move(socket), std::move(bound));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "control socket " + remote.endpoint + " cannot be bound", bind_hint(error.num()));
  }
}

std::optional<Incoming> ControlSocket::receive() {
  Incoming incoming;
  bool is_too_long = false;
  bool has_more = true;
  while (has_more) {
    zmq::message_t frame;
    if (!socket_.recv(frame, zmq::recv_flags::dontwait))
      return std::nullopt;  // frames of a message arrive together: only the first can be missing
    has_more = frame.more();
    if (is_remote() && !has_more) {
      const char* name = zmq_msg_gets(frame.handle(), "User-Id");  // set by the authenticator
      incoming.public_key = name == nullptr ? "" : name;           // empty: matches no key
    }
    is_too_long = is_too_long || incoming.envelope.size() == kMostFrames;
    if (!is_too_long) incoming.envelope.push_back(frame.to_string());
  }
  const bool has_delimiter = incoming.envelope.size() == 3 && incoming.envelope[1].empty();
  incoming.is_well_formed = !is_too_long && (incoming.envelope.size() == 2 || has_delimiter);
  if (!incoming.is_well_formed) {
    incoming.envelope.resize(1);
    return incoming;
  }
  incoming.payload = std::move(incoming.envelope.back());
  incoming.envelope.pop_back();
  return incoming;
}

void ControlSocket::reply(const std::vector<std::string>& envelope, const std::string& bytes) noexcept {
  const auto send = [this](const std::string& frame, int flags) {
    return zmq_send(socket_.handle(), frame.data(), frame.size(), flags | ZMQ_DONTWAIT) >= 0;
  };
  for (const std::string& frame : envelope) {
    if (!send(frame, ZMQ_SNDMORE)) return;
  }
  static_cast<void>(send(bytes, 0));
}

}  // namespace dts::ipc
