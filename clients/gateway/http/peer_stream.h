// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

namespace dts::gateway {

/// How many more bytes may be read from a peer. Unlimited until a limit is set. Reading stops when the budget is used up: Beast skips empty
/// fragments of a message without a notice, so an endless series of them is visible only in the bytes on the wire.
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

/// Any completion handler: movable, called once. TLS and TCP are compiled for this type only, not for each of Beast's handlers, which
/// halves the compile time of the server.
template <class... Results>
class AnyHandler {
 public:
  template <class Handler>
  requires(!std::same_as<std::decay_t<Handler>, AnyHandler>) explicit AnyHandler(Handler&& handler)
      : kept_(std::make_unique<KeptHandler<std::decay_t<Handler>>>(std::forward<Handler>(handler))) {}

  void operator()(Results... results) { std::exchange(kept_, nullptr)->call(results...); }

 private:
  struct Kept {
    virtual ~Kept() = default;
    virtual void call(Results... results) = 0;
  };
  template <class Handler>
  struct KeptHandler : Kept {
    explicit KeptHandler(Handler given) : handler(std::move(given)) {}
    void call(Results... results) override { handler(results...); }
    Handler handler;
  };

  std::unique_ptr<Kept> kept_;
};
using IoHandler = AnyHandler<boost::system::error_code, std::size_t>;
using EndHandler = AnyHandler<boost::system::error_code>;

/// The first non-empty buffers of any sequence. async_read_some and async_write_some may stop after them. `Buffer`: asio::mutable_buffer or
/// asio::const_buffer.
template <class Buffer>
class FirstBuffers {
 public:
  using value_type = Buffer;
  using const_iterator = const Buffer*;

  template <class Buffers>
  static FirstBuffers of(const Buffers& all) {
    FirstBuffers first;
    const auto end = boost::asio::buffer_sequence_end(all);
    for (auto buffer = boost::asio::buffer_sequence_begin(all); buffer != end && first.count_ < kMost; ++buffer) {
      if (Buffer(*buffer).size() > 0) first.buffers_[first.count_++] = *buffer;
    }
    return first;
  }
  [[nodiscard]] const_iterator begin() const noexcept { return buffers_.data(); }
  [[nodiscard]] const_iterator end() const noexcept { return buffers_.data() + count_; }

 private:
  static constexpr std::size_t kMost = 64;  // as many as Asio passes to one system call
  std::array<Buffer, kMost> buffers_;
  std::size_t count_ = 0;
};

/// A TCP connection, with or without TLS: one type, so that HTTP and WebSocket are compiled once. Models an Asio stream.
class PeerStream {
 public:
  using executor_type = boost::asio::io_context::executor_type;
  using Tcp = boost::beast::basic_stream<boost::asio::ip::tcp, executor_type, ReadBudget>;

  /// `tls`: null for plain TCP.
  PeerStream(boost::asio::ip::tcp::socket socket, executor_type executor, boost::asio::ssl::context* tls)
      : tcp_(std::make_unique<Tcp>(executor)) {
    const auto protocol = socket.local_endpoint().protocol();  // before the release: the order of evaluation of arguments is not defined
    tcp_->socket() = Tcp::socket_type(executor, protocol, socket.release());
    if (tls != nullptr) tls_ = std::make_unique<boost::asio::ssl::stream<Tcp&>>(*tcp_, *tls);
  }

  [[nodiscard]] executor_type get_executor() const noexcept { return tcp_->get_executor(); }
  [[nodiscard]] bool is_secure() const noexcept { return tls_ != nullptr; }
  [[nodiscard]] Tcp& tcp() noexcept { return *tcp_; }
  [[nodiscard]] ReadBudget& read_budget() noexcept { return tcp_->rate_policy(); }
  void close() { tcp_->close(); }

  /// Sets a deadline for every read and write that is in progress or starts later; the connection ends at the deadline.
  void expires_after(std::chrono::milliseconds time) { tcp_->expires_after(time); }
  void expires_never() { tcp_->expires_never(); }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read_some(FirstBuffers<boost::asio::mutable_buffer>::of(buffers), IoHandler(std::forward<Handler>(handler)));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write_some(FirstBuffers<boost::asio::const_buffer>::of(buffers), IoHandler(std::forward<Handler>(handler)));
  }

  /// TLS only.
  void async_handshake(EndHandler handler);
  void async_tls_shutdown(EndHandler handler);

 private:
  // Beast's WebSocket closes a stream of an unknown type with these functions; argument-dependent lookup finds them.
  friend void beast_close_socket(PeerStream& stream) { stream.close(); }
  template <class Handler>
  friend void async_teardown(boost::beast::role_type role, PeerStream& stream, Handler&& handler) {
    stream.tear_down(role, EndHandler(std::forward<Handler>(handler)));
  }
  friend void teardown(boost::beast::role_type, PeerStream& stream, boost::system::error_code&) { stream.close(); }

  void read_some(FirstBuffers<boost::asio::mutable_buffer> buffers, IoHandler handler);
  void write_some(FirstBuffers<boost::asio::const_buffer> buffers, IoHandler handler);
  void tear_down(boost::beast::role_type role, EndHandler handler);

  std::unique_ptr<Tcp> tcp_;
  std::unique_ptr<boost::asio::ssl::stream<Tcp&>> tls_;
};

}  // namespace dts::gateway
