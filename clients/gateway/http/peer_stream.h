// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <chrono>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

namespace dts::gateway {

/// How many more bytes may be read from a peer. Without a limit until one is set. Reading stops when it is used up: Beast skips empty
/// fragments of a message without telling anybody, so only the bytes on the wire show that they never end.
class ReadBudget {
 public:
  void allow(std::size_t bytes) noexcept { left_ = bytes; }
  void allow_more(std::size_t bytes) noexcept { left_ += bytes; }
  [[nodiscard]] bool is_used_up() const noexcept { return left_ == 0; }

 private:
  friend class boost::beast::rate_policy_access;
  [[nodiscard]] std::size_t available_read_bytes() const noexcept { return left_; }
  [[nodiscard]] std::size_t available_write_bytes() const noexcept { return std::numeric_limits<std::size_t>::max(); }
  void transfer_read_bytes(std::size_t bytes) noexcept { left_ -= std::min(left_, bytes); }
  void transfer_write_bytes(std::size_t) noexcept {}
  void on_timer() noexcept {}

  std::size_t left_ = std::numeric_limits<std::size_t>::max();
};

/// A TCP connection, with TLS or without: one type, so that HTTP and WebSocket are compiled once. A stream as Asio understands it.
class PeerStream {
 public:
  using executor_type = boost::asio::io_context::executor_type;
  using Tcp = boost::beast::basic_stream<boost::asio::ip::tcp, executor_type, ReadBudget>;

  /// `tls`: null for plain TCP.
  PeerStream(boost::asio::ip::tcp::socket socket, executor_type executor, boost::asio::ssl::context* tls)
      : tcp_(std::make_unique<Tcp>(executor)) {
    const auto protocol = socket.local_endpoint().protocol();  // before the release: arguments have no order
    tcp_->socket() = Tcp::socket_type(executor, protocol, socket.release());
    if (tls != nullptr) tls_ = std::make_unique<boost::asio::ssl::stream<Tcp&>>(*tcp_, *tls);
  }

  [[nodiscard]] executor_type get_executor() const noexcept { return tcp_->get_executor(); }
  [[nodiscard]] bool is_secure() const noexcept { return tls_ != nullptr; }
  [[nodiscard]] Tcp& tcp() noexcept { return *tcp_; }
  [[nodiscard]] ReadBudget& read_budget() noexcept { return tcp_->rate_policy(); }
  void close() { tcp_->close(); }

  /// Every read and write that begins or goes on from now on ends by then, with the connection.
  void expires_after(std::chrono::milliseconds time) { tcp_->expires_after(time); }
  void expires_never() { tcp_->expires_never(); }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (tls_) {
      tls_->async_read_some(buffers, std::forward<Handler>(handler));
    } else {
      tcp_->async_read_some(buffers, std::forward<Handler>(handler));
    }
  }

  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    if (tls_) {
      tls_->async_write_some(buffers, std::forward<Handler>(handler));
    } else {
      tcp_->async_write_some(buffers, std::forward<Handler>(handler));
    }
  }

  /// TLS only.
  template <class Handler>
  void async_handshake(Handler&& handler) {
    tls_->async_handshake(boost::asio::ssl::stream_base::server, std::forward<Handler>(handler));
  }
  template <class Handler>
  void async_tls_shutdown(Handler&& handler) {
    tls_->async_shutdown(std::forward<Handler>(handler));
  }

 private:
  // How Beast's WebSocket closes a stream it does not know; found by argument-dependent lookup.
  friend void beast_close_socket(PeerStream& stream) { stream.close(); }
  template <class Handler>
  friend void async_teardown(boost::beast::role_type role, PeerStream& stream, Handler&& handler) {
    using boost::beast::websocket::async_teardown;
    if (stream.tls_) {
      async_teardown(role, *stream.tls_, std::forward<Handler>(handler));
    } else {
      async_teardown(role, *stream.tcp_, std::forward<Handler>(handler));
    }
  }
  friend void teardown(boost::beast::role_type, PeerStream& stream, boost::system::error_code&) { stream.close(); }

  std::unique_ptr<Tcp> tcp_;
  std::unique_ptr<boost::asio::ssl::stream<Tcp&>> tls_;
};

}  // namespace dts::gateway
