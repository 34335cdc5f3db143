// SPDX-License-Identifier: Apache-2.0
#include "ipc/control_socket.h"

#include <utility>

#include "access/client_key.h"
#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

constexpr std::int64_t kLongestRequestBytes = 4 * 1024;  // our largest request has less than 3 kB
constexpr std::size_t kMostFrames = 4;
constexpr int kQueueMessages = 100;
constexpr int kHandshakeMs = 2000;  // then the connection ends

zmq::socket_t router(zmq::context_t& context) {
  zmq::socket_t socket(context, zmq::socket_type::router);
  socket.set(zmq::sockopt::linger, 200);  // time to send the last answers at shutdown
  socket.set(zmq::sockopt::maxmsgsize, kLongestRequestBytes);
  socket.set(zmq::sockopt::rcvhwm, kQueueMessages);
  socket.set(zmq::sockopt::sndhwm, kQueueMessages);
  socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
  return socket;
}

/// Moves payload and public key out of `frames`; the rest is the envelope.
Incoming sorted(std::vector<std::string> frames) {
  Incoming incoming;
  const std::size_t count = frames.size();
  const bool is_relayed = count == 4 && frames[2].size() == access::kKeyCharacters;
  incoming.is_well_formed = count == 2 || (count == 3 && frames[1].empty()) || is_relayed;
  if (incoming.is_well_formed) {
    incoming.payload = std::move(frames.back());
    frames.pop_back();
    if (is_relayed) {
      incoming.public_key = std::move(frames.back());
      frames.pop_back();
    }
  } else {
    frames.resize(1);
  }
  incoming.envelope = std::move(frames);
  return incoming;
}

}  // namespace

core::Result<ControlSocket> ControlSocket::bind(zmq::context_t& context, const std::string& endpoint) {
  DTS_TRY(check_endpoint(endpoint));
  DTS_TRY(check_not_in_use(endpoint));
  try {
    zmq::socket_t socket = router(context);
    socket.bind(endpoint);
    return ControlSocket(std::move(socket));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), "control socket " + endpoint + " cannot be bound", bind_hint(error.num()));
  }
}

std::optional<Incoming> ControlSocket::receive() {
  std::vector<std::string> frames;
  bool has_more = true;
  while (has_more) {
    zmq::message_t frame;
    if (!socket_.recv(frame, zmq::recv_flags::dontwait))
      return std::nullopt;  // frames of a message arrive together: only the first can be missing
    has_more = frame.more();
    if (frames.size() <= kMostFrames) frames.push_back(frame.to_string());  // one more than is allowed shows that there are too many
  }
  return sorted(std::move(frames));
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
