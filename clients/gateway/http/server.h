// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dts/error.h"
#include "gateway/access/identity.h"
#include "gateway/http/connection_limits.h"
#include "gateway/http/http_message.h"
#include "gateway/http/tab.h"

namespace dts::gateway {

/// Limits for what strangers can use up. A test attacks each of them.
struct ServerLimits {
  ConnectionLimits::Most connections{};  ///< Loopback counts as one address.
  std::size_t header_bytes = 8192;
  std::size_t body_bytes = 16384;
  std::size_t websocket_message_bytes = 65536;        ///< Whole message, summed over its fragments.
  std::chrono::milliseconds handshake_timeout{5000};  ///< For the TLS handshake, and for each request from its first byte to its last.
  std::chrono::milliseconds idle_timeout{30000};      ///< Between two requests; a WebSocket without any data (pings are sent meanwhile).
  std::chrono::milliseconds write_timeout{20000};     ///< For a peer that does not read.
  double requests_per_s = 50.0;                       ///< HTTP requests per connection; a burst may have four seconds' worth.
  double messages_per_s = 300.0;  ///< The same for WebSocket messages: a tab that paints 120 times a second sends a message each time.
  std::size_t unsent_bytes = 8U << 20U;  ///< Queued for a WebSocket whose peer does not read.
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;       ///< 0: any free port, see `Server::port`.
  std::string certificate_file{};  ///< PEM chain; with `key_file`: TLS 1.2 or newer only. Empty: plain HTTP.
  std::string key_file{};
  /// Names (without port) by which browsers may address the gateway, in addition to its address and, on loopback, "localhost". Any other
  /// name in a Host header is rejected, because it belongs to a foreign page (DNS rebinding).
  std::vector<std::string> host_names{};
  ServerLimits limits{};
};

/// What the transport needs from the rest of the gateway. All are called on the io thread.
struct ServerHooks {
  std::function<void(HttpRequest, Respond)> handle;                  ///< Any request that is not an upgrade.
  std::function<std::optional<Identity>(const HttpRequest&)> admit;  ///< Returns who requests "/ws"; nothing: 401.
  /// Called after the WebSocket's handshake, with the query of its address.
  std::function<std::unique_ptr<Tab>(const Identity&, const Query&, TabConnection&)> open_tab;
};

/// Counters since the start.
struct ServerStatistics {
  std::uint64_t connections_total = 0;
  std::uint64_t refused_connections_total = 0;        ///< Closed because of the limits in `connections`, at once or to make room.
  std::uint64_t refused_requests_total = 0;           ///< Malformed, too large, too slow, too many, foreign Host or Origin.
  std::map<unsigned, std::uint64_t> answers_total{};  ///< By HTTP status; WebSockets are counted as tabs.
  std::size_t connections = 0;
  std::size_t tabs = 0;
};

/// HTTP, HTTPS and WebSockets on one address. The server keeps strangers out; the hooks decide what is served.
///
///     accept --limits--> [TLS] --> request --Host--> handle --> answer, with security headers
///                                     \--"/ws": Origin, admit--> WebSocket "dts.v1" --> Tab
///
/// No compression (compression bombs need it); the size of whole messages is limited, however they are fragmented; every wait has a
/// deadline.
/// Thread: the one that runs `io`.
class Server {
 public:
  /// Starts to listen. Fails with InvalidArgument for unusable addresses and files, with Failed if the address is in use.
  [[nodiscard]] static client::Result<std::unique_ptr<Server>> open(boost::asio::io_context& io, const ServerOptions& options,
                                                                    ServerHooks hooks);
  virtual ~Server() = default;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] virtual std::uint16_t port() const noexcept = 0;
  [[nodiscard]] virtual ServerStatistics statistics() const noexcept = 0;
  /// Closes the listener and every connection (WebSockets with code 1001).
  virtual void stop() = 0;

 protected:
  Server() = default;
};

}  // namespace dts::gateway
