// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/http_session.h"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/token_bucket.h"
#include "gateway/http/body_source.h"
#include "gateway/http/json_answer.h"
#include "gateway/http/peer_stream.h"
#include "gateway/http/request_check.h"
#include "gateway/http/response_head.h"
#include "gateway/http/websocket_session.h"

namespace dts::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

/// Limits in time and bytes for reading from a peer after its last answer. Closing with unread bytes would reset the connection, and the
/// peer might not receive the reason for the rejection.
constexpr std::chrono::seconds kLingerTime{2};
constexpr std::size_t kLingerBytes = 256U << 10U;

/// Handles one request after the other:
///
///     wait for the first byte (idle_timeout) --> read the rest (handshake_timeout) --> check --> route --> write head, pieces
///            ^                                                                                                |
///            +------------------------------------------- keep-alive ----------------------------------------+--> linger, close
class HttpSession : public Connection, public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(std::shared_ptr<ServerState> server, asio::ip::tcp::socket socket, Peer peer, ConnectionLimits::Seat seat)
      : Connection(std::move(server), std::move(peer), std::move(seat)),
        stream_(std::move(socket), server_->io.get_executor(), server_->tls.get()),
        requests_(server_->limits.requests_per_s) {
    seat_.on_eviction([this] { drop(); });
  }

  void start();
  void go_away() override { drop(); }
  void drop() override {
    if (std::exchange(is_over_, true)) return;
    if (body_) body_->give_up();
    stream_.close();
  }

 private:
  void await_request();
  void read_request();
  void on_request(error_code error);
  [[nodiscard]] std::optional<Identity> identify(const HttpRequest& request);
  void route(HttpRequest request);
  void upgrade(RawRequest raw, const HttpRequest& request);
  void refuse(HttpResponse response);
  void answer(std::uint64_t number, HttpResponse response);
  void write(std::string_view bytes);
  void write_piece();
  void end_answer();
  void end_connection();
  void linger();

  PeerStream stream_;
  beast::flat_buffer buffer_{16384};  // holds a whole header, and pipelined requests until they are handled
  std::optional<http::request_parser<http::string_body>> parser_;
  core::TokenBucket requests_;
  std::uint64_t request_number_ = 0;
  std::uint64_t answered_number_ = 0;
  bool is_over_ = false;
  bool is_head_request_ = false;
  bool keeps_alive_ = false;
  std::string path_;
  std::string head_;
  std::optional<BodySource> body_;
  std::array<char, 4096> unread_{};
  std::size_t lingered_bytes_ = 0;
};

void HttpSession::start() {
  if (!stream_.is_secure()) return await_request();
  stream_.expires_after(server_->limits.handshake_timeout);
  stream_.async_handshake(EndHandler([self = shared_from_this()](error_code error) {
    if (!error) self->await_request();
  }));
}

void HttpSession::await_request() {
  if (is_over_) return;
  if (buffer_.size() > 0) return read_request();
  stream_.expires_after(server_->limits.idle_timeout);
  stream_.async_read_some(buffer_.prepare(2048), [self = shared_from_this()](error_code error, std::size_t bytes) {
    if (error) return;
    self->buffer_.commit(bytes);
    self->read_request();
  });
}

void HttpSession::read_request() {
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(server_->limits.header_bytes));
  parser_->body_limit(server_->limits.body_bytes);
  stream_.expires_after(server_->limits.handshake_timeout);
  http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) { self->on_request(error); });
}

void HttpSession::on_request(error_code error) {
  if (is_over_) return;
  stream_.expires_never();
  ++request_number_;
  keeps_alive_ = false;
  path_.clear();
  is_head_request_ = parser_->is_header_done() && parser_->get().method() == http::verb::head;
  if (error) {
    if (auto response = refuse_unreadable(error)) return refuse(std::move(*response));
    if (error != http::error::end_of_stream) ++server_->statistics.refused_requests_total;
    return;
  }
  if (!requests_.take(std::chrono::steady_clock::now())) {
    auto response = error_answer(429, "too many requests", "wait a moment");
    response.headers.emplace_back("Retry-After", "1");
    return refuse(std::move(response));
  }
  auto raw = parser_->release();
  const bool keeps_alive = raw.keep_alive();
  const bool is_upgrade = beast::websocket::is_upgrade(raw);
  auto request = check_request(is_upgrade ? RawRequest(raw) : std::move(raw), peer_, stream_.is_secure(), server_->hosts);
  if (!request) return refuse(std::move(request.error()));
  path_ = request->path;
  if (is_upgrade) return upgrade(std::move(raw), *request);
  keeps_alive_ = keeps_alive;
  // A logged-in user gets a user's place and need not make room for strangers. Connections beyond the user's limit stay strangers.
  if (request->headers.contains("cookie")) {
    const auto identity = identify(*request);
    if (identity && identity->user != kLocalUser) static_cast<void>(seat_.belongs_to(identity->user));
  }
  route(std::move(*request));
}

std::optional<Identity> HttpSession::identify(const HttpRequest& request) {
  std::optional<Identity> identity;
  return returns([&] { identity = server_->hooks.admit(request); }) ? identity : std::nullopt;
}

void HttpSession::route(HttpRequest request) {
  const auto respond = [self = shared_from_this(), number = request_number_](HttpResponse response) {
    self->answer(number, std::move(response));
  };
  if (!returns([&] { server_->hooks.handle(std::move(request), respond); })) {
    respond(error_answer(500, "internal error of the gateway", "read its log: journalctl -u dts-gateway"));
  }
}

void HttpSession::upgrade(RawRequest raw, const HttpRequest& request) {
  if (auto refused = refuse_upgrade(raw, request)) return refuse(std::move(*refused));
  // A browser sends data only after the answer; earlier bytes would be parsed as a request, or lost.
  if (buffer_.size() > 0) return refuse(error_answer(400, "data before the answer to the upgrade", "wait for it"));
  auto identity = identify(request);
  if (!identity) return refuse(error_answer(401, "not logged in", "log in first"));
  if (!seat_.belongs_to(identity->user)) {
    return refuse(error_answer(503, "too many connections of this user", "close other tabs of the dashboard"));
  }
  is_over_ = true;
  serve_websocket(server_, std::move(stream_), std::move(peer_), std::move(seat_), std::move(raw), request.query, std::move(*identity));
}

void HttpSession::refuse(HttpResponse response) {
  ++server_->statistics.refused_requests_total;
  answer(request_number_, std::move(response));
}

/// Routes may answer late, twice or after the end of the connection. Sends one answer per request, and none after the end.
void HttpSession::answer(std::uint64_t number, HttpResponse response) {
  if (is_over_ || number != request_number_ || number == answered_number_) {
    const BodySource given_up(std::move(response.body));
    return;
  }
  answered_number_ = number;
  body_.emplace(std::move(response.body));
  if (!body_->is_good()) {
    response = error_answer(404, "the file no longer exists", "request it again");
    body_.emplace(response.body);
  }
  ++server_->statistics.answers_total[response.status];
  const AnswerFrame frame{.path = path_, .is_secure = stream_.is_secure(), .keeps_alive = keeps_alive_, .body_bytes = body_->size_bytes()};
  head_ = response_head(response, frame);
  if (is_head_request_ || !may_have_body(response.status)) body_.reset();
  write(head_);
}

/// Each piece has its own deadline, because large exports over slow links need long.
void HttpSession::write(std::string_view bytes) {
  stream_.expires_after(server_->limits.write_timeout);
  asio::async_write(stream_, asio::buffer(bytes.data(), bytes.size()), [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return self->drop();
    self->write_piece();
  });
}

void HttpSession::write_piece() {
  if (is_over_) return;
  if (!body_) return end_answer();
  const auto piece = body_->next();
  if (!piece) return drop();
  if (piece->empty()) return end_answer();
  write(*piece);
}

void HttpSession::end_answer() {
  body_.reset();
  if (keeps_alive_) return await_request();
  end_connection();
}

void HttpSession::end_connection() {
  stream_.expires_after(kLingerTime);
  if (stream_.is_secure()) return stream_.async_tls_shutdown(EndHandler([self = shared_from_this()](error_code) { self->drop(); }));
  error_code ignored;
  stream_.tcp().socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  linger();
}

void HttpSession::linger() {
  stream_.async_read_some(asio::buffer(unread_), [self = shared_from_this()](error_code error, std::size_t bytes) {
    self->lingered_bytes_ += bytes;
    if (error || self->lingered_bytes_ > kLingerBytes) return self->drop();
    self->linger();
  });
}

}  // namespace

void serve_http(std::shared_ptr<ServerState> server, asio::ip::tcp::socket socket, Peer peer, ConnectionLimits::Seat seat) {
  std::make_shared<HttpSession>(std::move(server), std::move(socket), std::move(peer), std::move(seat))->start();
}

}  // namespace dts::gateway
