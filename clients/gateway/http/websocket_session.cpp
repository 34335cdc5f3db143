// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/websocket_session.h"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/token_bucket.h"

namespace dts::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// Disconnects a peer that does not answer a close frame within this time.
constexpr std::chrono::seconds kCloseTime{2};
/// Bytes on the wire for a message, or a control frame, in addition to its payload: frame headers, TLS records.
constexpr std::size_t kMessageOverheadBytes = 16U << 10U;
constexpr std::size_t kControlOverheadBytes = 70;
constexpr std::size_t kLongestReason = 120;

/// One WebSocket and its Tab. Beast handles the protocol, the pings and the idle deadline. This class adds the queue of unsent messages,
/// the deadline for a write, the limit for messages per second, and a limit for endless messages.
class WebSocketSession : public Connection, public TabConnection, public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(std::shared_ptr<ServerState> server, PeerStream stream, Peer peer, ConnectionLimits::Seat seat, Query query,
                   Identity identity)
      : Connection(std::move(server), std::move(peer), std::move(seat)),
        query_(std::move(query)),
        identity_(std::move(identity)),
        socket_(std::move(stream)),
        watch_(server_->io),
        messages_(server_->limits.messages_per_s) {}
  ~WebSocketSession() override { end(); }

  void start(RawRequest upgrade);
  void send(std::string message) override;
  [[nodiscard]] std::size_t unsent_bytes() const noexcept override { return unsent_bytes_; }
  void close(unsigned code, std::string reason) override;
  void go_away() override { give_up(websocket::close_code::going_away, "the gateway is stopping"); }
  void drop() override { end(); }

 private:
  void prepare();
  void open();
  void read();
  void on_message();
  void on_control(websocket::frame_type kind, std::size_t payload_bytes);
  void write();
  void on_written(error_code error);
  void give_up(unsigned code, const char* reason);
  void send_close();
  void watch();
  void end();

  Query query_;
  Identity identity_;
  websocket::stream<PeerStream, false> socket_;  // false: compiled without permessage-deflate
  asio::steady_timer watch_;
  core::TokenBucket messages_;
  beast::flat_buffer incoming_;
  std::deque<std::string> outgoing_;
  std::size_t unsent_bytes_ = 0;
  std::optional<Clock::time_point> writes_since_;
  std::optional<Clock::time_point> closes_since_;
  websocket::close_reason reason_;
  bool is_open_ = false;
  bool is_over_ = false;
  bool is_close_sent_ = false;
  std::unique_ptr<Tab> tab_;
};

void WebSocketSession::prepare() {
  const ServerLimits& limits = server_->limits;
  socket_.next_layer().expires_never();  // from here on Beast's own deadlines apply
  socket_.set_option(websocket::stream_base::timeout{
      .handshake_timeout = limits.handshake_timeout, .idle_timeout = limits.idle_timeout, .keep_alive_pings = true});
  socket_.set_option(
      websocket::stream_base::decorator([](websocket::response_type& response) { response.set("Sec-WebSocket-Protocol", "dts.v1"); }));
  socket_.read_message_max(limits.websocket_message_bytes);
  socket_.binary(true);
  socket_.auto_fragment(false);
  socket_.control_callback([this](websocket::frame_type kind, beast::string_view payload) { on_control(kind, payload.size()); });
}

void WebSocketSession::start(RawRequest upgrade) {
  prepare();
  // Beast reads the request before this call returns and keeps no reference to it.
  socket_.async_accept(upgrade, [self = shared_from_this()](error_code error) {
    if (!error) self->open();
  });
}

void WebSocketSession::open() {
  if (is_over_) return;
  is_open_ = true;
  ++server_->statistics.tabs;
  socket_.next_layer().read_budget().allow(server_->limits.websocket_message_bytes + kMessageOverheadBytes);
  if (!returns([&] { tab_ = server_->hooks.open_tab(identity_, query_, *this); }) || !tab_) {
    close(websocket::close_code::internal_error, "internal error of the gateway");
  }
  watch();
  read();
}

void WebSocketSession::read() {
  socket_.async_read(incoming_, [self = shared_from_this()](error_code error, std::size_t) {
    // While a close frame waits to be sent, Beast ends the read; the close itself continues.
    if (error) return self->is_close_sent_ ? void() : self->end();
    self->on_message();
  });
}

void WebSocketSession::on_message() {
  if (is_over_) return;
  const std::string_view message(static_cast<const char*>(incoming_.data().data()), incoming_.size());
  if (!closes_since_) {
    if (socket_.got_text()) {
      give_up(websocket::close_code::unknown_data, "binary messages only");
    } else if (!messages_.take(Clock::now())) {
      give_up(websocket::close_code::policy_error, "too many messages");
    } else if (!returns([&] { tab_->on_message(message); })) {
      give_up(websocket::close_code::internal_error, "internal error of the gateway");
    }
  }
  incoming_.clear();
  socket_.next_layer().read_budget().allow(server_->limits.websocket_message_bytes + kMessageOverheadBytes);
  if (!is_close_sent_ && !is_over_) read();
}

/// Beast calls this during a read: the stream must not be used here.
void WebSocketSession::on_control(websocket::frame_type kind, std::size_t payload_bytes) {
  socket_.next_layer().read_budget().allow_more(payload_bytes + kControlOverheadBytes);
  if (kind == websocket::frame_type::close || messages_.take(Clock::now())) return;
  asio::post(server_->io, [self = shared_from_this()] { self->give_up(websocket::close_code::policy_error, "too many pings"); });
}

void WebSocketSession::send(std::string message) {
  if (!is_open_ || is_over_ || closes_since_) return;
  if (unsent_bytes_ + message.size() > server_->limits.unsent_bytes) {
    return give_up(websocket::close_code::policy_error, "the browser does not read its messages");
  }
  unsent_bytes_ += message.size();
  outgoing_.push_back(std::move(message));
  if (!writes_since_) write();
}

void WebSocketSession::write() {
  writes_since_ = Clock::now();
  socket_.async_write(asio::buffer(outgoing_.front()),
                      [self = shared_from_this()](error_code error, std::size_t) { self->on_written(error); });
}

void WebSocketSession::on_written(error_code error) {
  if (is_over_) return;
  writes_since_.reset();
  if (error) return is_close_sent_ ? void() : end();
  unsent_bytes_ -= outgoing_.front().size();
  outgoing_.pop_front();
  if (!outgoing_.empty()) {
    write();
  } else if (closes_since_) {
    send_close();
  }
}

/// Messages queued before the close are sent first.
void WebSocketSession::close(unsigned code, std::string reason) {
  if (is_over_ || closes_since_) return;
  reason.resize(std::min(reason.size(), kLongestReason));
  reason_ = websocket::close_reason(static_cast<websocket::close_code>(code), reason);
  closes_since_ = Clock::now();
  if (!is_open_) return end();
  if (!writes_since_) send_close();
}

/// Closes without the waiting messages, except for one that is partly sent.
void WebSocketSession::give_up(unsigned code, const char* reason) {
  while (outgoing_.size() > (writes_since_ ? 1U : 0U)) {
    unsent_bytes_ -= outgoing_.back().size();
    outgoing_.pop_back();
  }
  close(code, reason);
}

void WebSocketSession::send_close() {
  if (std::exchange(is_close_sent_, true)) return;
  socket_.async_close(reason_, [self = shared_from_this()](error_code) { self->end(); });
}

/// Checks the deadlines that Beast does not have.
void WebSocketSession::watch() {
  const ServerLimits& limits = server_->limits;
  const auto now = Clock::now();
  if (writes_since_ && now - *writes_since_ > limits.write_timeout) return end();
  if (closes_since_ && now - *closes_since_ > kCloseTime) return end();
  if (socket_.next_layer().read_budget().is_used_up()) give_up(websocket::close_code::policy_error, "a message without an end");
  watch_.expires_after(std::clamp<Clock::duration>(limits.write_timeout / 4, std::chrono::milliseconds(10), std::chrono::seconds(1)));
  watch_.async_wait([weak = weak_from_this()](error_code error) {
    const auto self = weak.lock();
    if (!error && self && !self->is_over_) self->watch();
  });
}

void WebSocketSession::end() {
  if (std::exchange(is_over_, true)) return;
  if (is_open_) --server_->statistics.tabs;
  tab_.reset();
  watch_.cancel();
  socket_.next_layer().close();
}

}  // namespace

void serve_websocket(std::shared_ptr<ServerState> server, PeerStream stream, Peer peer, ConnectionLimits::Seat seat, RawRequest upgrade,
                     Query query, Identity identity) {
  std::make_shared<WebSocketSession>(std::move(server), std::move(stream), std::move(peer), std::move(seat), std::move(query),
                                     std::move(identity))
      ->start(std::move(upgrade));
}

}  // namespace dts::gateway
