// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <zmq.hpp>

#include "access/gate.h"
#include "core/clock.h"
#include "core/log.h"
#include "relay/message_limit.h"
#include "relay/remote_listener.h"

namespace dts::relay {

/// Passes commands of other machines to dtsd with the key of their sender, and the answers back. Decodes no command: dtsd decides what the
/// key may do, at each command.
///
///     client --CURVE--> ROUTER --[ticket] [public key] [request]--> DEALER --> dtsd's control socket
///     client <--------- ROUTER <--[ticket] [response]-------------- DEALER <--
///
/// The ticket holds the client's routing ID, so nothing is remembered between a command and its answer. Thread: one.
class ControlRelay {
 public:
  /// Binds `remote`. `local`: dtsd's control endpoint; connects to it in the background, and again whenever it was away. `keys` and `clock`
  /// must outlive this object.
  [[nodiscard]] static core::Result<ControlRelay> open(zmq::context_t& context, const RemoteEndpoint& remote, const std::string& local,
                                                       const access::KeyStore& keys, core::Clock& clock, core::Log log);

  /// Waits for messages for at most `ms`, then passes those that have arrived.
  void serve(int ms);
  /// Ends all connections: a key was revoked. Returns false if nothing listens now; try again later.
  [[nodiscard]] bool drop_peers() noexcept { return listener_.drop_connections(); }

 private:
  struct Incoming {
    std::string client;          ///< Routing ID.
    bool has_delimiter = false;  ///< An empty frame follows it, from REQ sockets.
    std::string public_key;      ///< "User-Id", which the authenticator has set.
    std::string request;
    bool is_well_formed = false;
  };
  ControlRelay(RemoteListener listener, zmq::socket_t dealer, const access::KeyStore& keys, core::Clock& clock, core::Log log)
      : listener_(std::move(listener)), dealer_(std::move(dealer)), senders_(&keys), clock_(clock), log_(std::move(log)) {}
  [[nodiscard]] std::optional<Incoming> receive();
  void pass(const Incoming& incoming);
  [[nodiscard]] bool forward(const Incoming& incoming);
  [[nodiscard]] bool pass_answer();
  void answer(std::string_view client, bool has_delimiter, std::string_view response);
  void refuse(const Incoming& incoming, const core::Error& error);
  void note_rejected(const std::string& who);
  void log_rejected();

  RemoteListener listener_;
  zmq::socket_t dealer_;
  access::Gate senders_;
  core::Clock& clock_;
  core::Log log_;
  MessageLimit limit_;
  std::uint64_t unlogged_rejections_ = 0;
  std::string last_rejected_;
  std::int64_t next_log_ns_ = 0;
};

}  // namespace dts::relay
