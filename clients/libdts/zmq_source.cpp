// SPDX-License-Identifier: Apache-2.0
#include "zmq_source.h"

#include <algorithm>
#include <cerrno>
#include <tuple>

#include "curve.h"

namespace dts::client {
namespace {

constexpr int kQuietS = 2;  // after this silence, the kernel probes the peer every second
constexpr int kGoneMs = 5000;

/// Lets the kernel end the connection of a peer that vanished from the network, also while nobody reads. Does not use libzmq's heartbeats:
/// they abort the process if the peer leaves while the queue is full (4.3.4 and 4.3.5: the timer calls out_event(), which asserts
/// !_io_error).
void watch_for_dead_peers(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, kQuietS);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, 1);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, kGoneMs / 1000);
  socket.set(zmq::sockopt::tcp_maxrt, kGoneMs);
}

}  // namespace

ZmqSource::ZmqSource(const SourceOptions& options) : socket_(context_, zmq::socket_type::sub) {
  socket_.set(zmq::sockopt::linger, 0);
  socket_.set(zmq::sockopt::rcvhwm, options.queue_messages);
  socket_.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(options.largest_message));
  watch_for_dead_peers(socket_);
  socket_.set(zmq::sockopt::reconnect_ivl, static_cast<int>(kFirstReconnect.count()));
  socket_.set(zmq::sockopt::reconnect_ivl_max, static_cast<int>(kSlowestReconnect.count()));
  if (options.key) use(socket_, *options.key);
  socket_.connect(options.endpoint);
}

std::optional<RawMessage> ZmqSource::take() {
  if (!socket_.recv(topic_, zmq::recv_flags::dontwait)) return std::nullopt;
  if (!topic_.more()) return RawMessage{};
  // The frames of a message arrive together, so this does not block.
  std::ignore = socket_.recv(body_, zmq::recv_flags::none);
  if (!body_.more()) {
    return RawMessage{.topic = topic_.to_string_view(), .body = {body_.data<std::byte>(), body_.size()}, .is_well_formed = true};
  }
  while (body_.more()) std::ignore = socket_.recv(body_, zmq::recv_flags::none);
  return RawMessage{};
}

Waited ZmqSource::wait(std::chrono::milliseconds timeout) {
  zmq::pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
  try {
    return zmq::poll(&item, 1, timeout) > 0 ? Waited::Ready : Waited::TimedOut;
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return Waited::Interrupted;
    throw;
  }
}

}  // namespace dts::client
