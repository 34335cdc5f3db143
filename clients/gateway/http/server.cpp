// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "cli/try.h"
#include "gateway/http/http_session.h"
#include "gateway/http/server_state.h"
#include "gateway/http/tls_context.h"

namespace dts::gateway {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// After a lack of file descriptors: connections that end during the pause release some.
constexpr std::chrono::milliseconds kPauseAfterFailure{100};

/// Accepts connections. Outlives the Server while its handlers wait in `io`.
class Listener : public std::enable_shared_from_this<Listener> {
 public:
  explicit Listener(std::shared_ptr<ServerState> state) : state_(std::move(state)), acceptor_(state_->io), pause_(state_->io) {}

  [[nodiscard]] error_code listen(const tcp::endpoint& endpoint);
  void accept();
  void close();
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

 private:
  void greet(tcp::socket socket);

  std::shared_ptr<ServerState> state_;
  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  std::uint16_t port_ = 0;
};

error_code Listener::listen(const tcp::endpoint& endpoint) {
  error_code error;
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  if (!error) port_ = acceptor_.local_endpoint(error).port();
  return error;
}

void Listener::accept() {
  acceptor_.async_accept([self = shared_from_this()](error_code error, tcp::socket socket) {
    if (!self->acceptor_.is_open()) return;
    if (!error) {
      self->greet(std::move(socket));
      return self->accept();
    }
    self->pause_.expires_after(kPauseAfterFailure);
    self->pause_.async_wait([self](error_code cancelled) {
      if (!cancelled && self->acceptor_.is_open()) self->accept();
    });
  });
}

void Listener::greet(tcp::socket socket) {
  error_code error;
  const auto remote = unmapped(socket.remote_endpoint(error).address());
  const auto local = error ? remote : unmapped(socket.local_endpoint(error).address());
  if (error) return;  // already closed
  ++state_->statistics.connections_total;
  auto seat = state_->seats.take_seat(remote);
  if (!seat) {
    ++state_->statistics.refused_connections_total;
    return;
  }
  socket.set_option(tcp::no_delay(true), error);
  serve_http(state_, std::move(socket), {.remote_address = remote.to_string(), .local_address = local.to_string()}, std::move(*seat));
}

void Listener::close() {
  error_code ignored;
  acceptor_.close(ignored);
  pause_.cancel();
}

class TcpServer : public Server {
 public:
  TcpServer(std::shared_ptr<ServerState> state, std::shared_ptr<Listener> listener)
      : state_(std::move(state)), listener_(std::move(listener)) {}
  ~TcpServer() override {
    listener_->close();
    for (Connection* connection : connections()) connection->drop();
  }

  [[nodiscard]] std::uint16_t port() const noexcept override { return listener_->port(); }
  [[nodiscard]] ServerStatistics statistics() const noexcept override {
    ServerStatistics now = state_->statistics;
    now.connections = state_->seats.taken();
    now.refused_connections_total += state_->seats.evicted_total();
    return now;
  }
  void stop() override {
    listener_->close();
    for (Connection* connection : connections()) connection->go_away();
  }

 private:
  /// drop() and go_away() destroy none of them: pending handlers in `io` hold them.
  [[nodiscard]] std::set<Connection*> connections() const { return state_->connections; }

  std::shared_ptr<ServerState> state_;
  std::shared_ptr<Listener> listener_;
};

client::Result<tcp::endpoint> endpoint_of(const ServerOptions& options) {
  error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error) {
    return client::fail(client::ErrorCode::InvalidArgument, "cannot listen on \"" + options.address + "\": not an address",
                        "give it in digits: 127.0.0.1, ::1, 0.0.0.0");
  }
  return tcp::endpoint(address, options.port);
}

}  // namespace

client::Result<std::unique_ptr<Server>> Server::open(asio::io_context& io, const ServerOptions& options, ServerHooks hooks) {
  DTS_TRY_ASSIGN(const auto endpoint, endpoint_of(options));
  auto state = std::make_shared<ServerState>(io, options, std::move(hooks), endpoint.address().is_loopback());
  if (!options.certificate_file.empty() || !options.key_file.empty()) {
    DTS_TRY_ASSIGN(state->tls, open_tls(options.certificate_file, options.key_file));
  }
  auto listener = std::make_shared<Listener>(state);
  if (const error_code error = listener->listen(endpoint)) {
    return client::fail(client::ErrorCode::Failed,
                        "cannot listen on " + options.address + " port " + std::to_string(options.port) + ": " + error.message(),
                        "another program may listen there; choose another port: --listen ADDRESS:PORT");
  }
  listener->accept();
  return std::make_unique<TcpServer>(std::move(state), std::move(listener));
}

}  // namespace dts::gateway
