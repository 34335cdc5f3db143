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

/// What strangers may use up. Every figure is tested by an attack on it.
struct ServerLimits {
  ConnectionLimits::Most connections{};  ///< Loopback counts as one address.
  std::size_t header_bytes = 8192;
  std::size_t body_bytes = 16384;
  std::size_t websocket_message_bytes = 65536;        ///< Whole message, over all its fragments.
  std::chrono::milliseconds handshake_timeout{5000};  ///< TLS, and each request from its first byte to its last.
  std::chrono::milliseconds idle_timeout{30000};      ///< Between two requests; silence of a WebSocket (pings are sent in between).
  std::chrono::milliseconds write_timeout{20000};     ///< A peer that does not read.
  double requests_per_s = 50.0;                       ///< HTTP requests per connection; bursts of four seconds' worth.
  double messages_per_s = 300.0;         ///< The same of WebSocket messages: a tab that paints 120 times a second says so each time.
  std::size_t unsent_bytes = 8U << 20U;  ///< Queued for a WebSocket that does not take them.
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;       ///< 0: any, see `Server::port`.
  std::string certificate_file{};  ///< PEM chain; with `key_file`: TLS 1.2 or newer only. Empty: plain HTTP.
  std::string key_file{};
  /// Names (without port) by which browsers may call us, besides the address itself and, on loopback, "localhost": whatever else
  /// stands in a Host header is refused, since it is somebody else's page (DNS rebinding).
  std::vector<std::string> host_names{};
  ServerLimits limits{};
};

/// What the transport asks of the rest. All are called on the io thread.
struct ServerHooks {
  std::function<void(HttpRequest, Respond)> handle;                               ///< Any request but an upgrade.
  std::function<std::optional<Identity>(const HttpRequest&)> admit;               ///< Who asks for "/ws"; nothing: 401.
  std::function<std::unique_ptr<Tab>(const Identity&, TabConnection&)> open_tab;  ///< After the WebSocket's handshake.
};

/// Counters since the start.
struct ServerStatistics {
  std::uint64_t connections_total = 0;
  std::uint64_t refused_connections_total = 0;        ///< Closed by the limits of `connections`, at once or to make room.
  std::uint64_t refused_requests_total = 0;           ///< Malformed, too large, too slow, too many, foreign Host or Origin.
  std::map<unsigned, std::uint64_t> answers_total{};  ///< By HTTP status; WebSockets are tabs.
  std::size_t connections = 0;
  std::size_t tabs = 0;
};

/// HTTP, HTTPS and WebSockets on one address: what keeps strangers out is in here, what is served is not.
///
///     accept --limits--> [TLS] --> request --Host--> handle --> answer, with security headers
///                                     \--"/ws": Origin, admit--> WebSocket "dts.v1" --> Tab
///
/// No compression (a bomb needs one), whole messages bounded whatever their fragments, every wait has a deadline.
/// Thread: the one that runs `io`.
class Server {
 public:
  /// Listens. Fails with InvalidArgument for addresses and files that cannot be used, Failed when the address is taken.
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
