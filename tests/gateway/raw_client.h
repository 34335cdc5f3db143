// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace dts::test {

/// A TCP connection to 127.0.0.1 on which anything may be said, however wrong. Every wait ends after kMostWait.
class RawClient {
 public:
  static constexpr std::chrono::seconds kMostWait{60};

  /// `receive_bytes`: of the kernel's buffer, for those who do not read.
  explicit RawClient(std::uint16_t port, int receive_bytes = 0) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_bytes > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    const timeval wait{.tv_sec = kMostWait.count(), .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &wait, sizeof wait);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~RawClient() {
    if (socket_ >= 0) ::close(socket_);
  }
  RawClient(RawClient&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), is_connected_(other.is_connected_), received_(std::move(other.received_)) {}
  RawClient& operator=(RawClient&&) = delete;

  [[nodiscard]] bool is_connected() const noexcept { return is_connected_; }
  [[nodiscard]] int socket() const noexcept { return socket_; }

  /// False: the peer closed.
  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  void end_of_sending() const { ::shutdown(socket_, SHUT_WR); }

  /// Whether the peer has closed, or closes within `wait`; what it says meanwhile is kept.
  [[nodiscard]] bool is_closed_within(std::chrono::milliseconds wait) {
    const auto deadline = std::chrono::steady_clock::now() + wait;
    while (receive_more(deadline)) {
    }
    return is_at_end_;
  }

  /// Everything until the peer closes.
  [[nodiscard]] std::string read_to_end() {
    static_cast<void>(is_closed_within(kMostWait));
    return std::exchange(received_, {});
  }

  /// `count` bytes, or fewer when the peer closes.
  [[nodiscard]] std::string read_bytes(std::size_t count) {
    const auto deadline = std::chrono::steady_clock::now() + kMostWait;
    while (received_.size() < count && receive_more(deadline)) {
    }
    std::string bytes = received_.substr(0, count);
    received_.erase(0, bytes.size());
    return bytes;
  }

  /// The head of an answer with its empty line.
  [[nodiscard]] std::string read_head() {
    const auto deadline = std::chrono::steady_clock::now() + kMostWait;
    while (received_.find("\r\n\r\n") == std::string::npos && receive_more(deadline)) {
    }
    const std::size_t end = received_.find("\r\n\r\n");
    return end == std::string::npos ? read_bytes(received_.size()) : read_bytes(end + 4);
  }

  /// Head and body by its Content-Length.
  [[nodiscard]] std::string read_answer() {
    const std::string head = read_head();
    const std::size_t at = head.find("Content-Length: ");
    return at == std::string::npos ? head : head + read_bytes(std::stoul(head.substr(at + 16)));
  }

 private:
  bool receive_more(std::chrono::steady_clock::time_point deadline) {
    // Rounded up: a wait of a millisecond is a look, not none.
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (is_at_end_ || left <= 0 || ::poll(&waiting, 1, static_cast<int>(left)) <= 0) return false;
    char piece[16384];
    const ssize_t got = ::recv(socket_, piece, sizeof piece, 0);
    is_at_end_ = got <= 0;
    if (got > 0) received_.append(piece, static_cast<std::size_t>(got));
    return !is_at_end_;
  }

  int socket_;
  bool is_connected_ = false;
  bool is_at_end_ = false;
  std::string received_;
};

/// "200", or "" for no answer.
[[nodiscard]] inline std::string status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? answer.substr(9, 3) : std::string();
}

/// A request with the Host header that fits.
[[nodiscard]] inline std::string request(std::uint16_t port, const std::string& first_words, const std::string& more_headers = {},
                                         const std::string& body = {}) {
  return first_words + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + more_headers + "\r\n" + body;
}

/// The headers by which a page of ours asks for a WebSocket.
[[nodiscard]] inline std::string upgrade_headers(std::uint16_t port) {
  return "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Protocol: dts.v1\r\nOrigin: http://127.0.0.1:" +
         std::to_string(port) + "\r\n";
}

/// One WebSocket frame of a client (RFC 6455, 5.2), masked with zeros.
[[nodiscard]] inline std::string frame(unsigned char first_byte, const std::string& payload) {
  std::string bytes(1, static_cast<char>(first_byte));
  const std::size_t size = payload.size();
  const int length_bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
  bytes.push_back(static_cast<char>(0x80U | (length_bytes == 0 ? size : length_bytes == 2 ? 126U : 127U)));
  for (int byte = length_bytes; byte-- > 0;) bytes.push_back(static_cast<char>(size >> (8U * static_cast<unsigned>(byte))));
  return bytes + std::string(4, '\0') + payload;
}
inline constexpr unsigned char kFin = 0x80;
inline constexpr unsigned char kRsv1 = 0x40;
inline constexpr unsigned char kContinuation = 0x0;
inline constexpr unsigned char kText = 0x1;
inline constexpr unsigned char kBinary = 0x2;
inline constexpr unsigned char kClose = 0x8;
inline constexpr unsigned char kPing = 0x9;
inline constexpr unsigned char kPong = 0xA;

struct ServerFrame {
  unsigned opcode = 0;
  std::string payload;

  /// Of a close frame.
  [[nodiscard]] unsigned close_code() const {
    if (opcode != kClose || payload.size() < 2) return 0;
    return static_cast<unsigned char>(payload[0]) * 256U + static_cast<unsigned char>(payload[1]);
  }
};

/// The server's next frame; nothing when it closes without one.
[[nodiscard]] inline std::optional<ServerFrame> read_frame(RawClient& client) {
  const std::string head = client.read_bytes(2);
  if (head.size() < 2) return std::nullopt;
  std::size_t size = static_cast<unsigned char>(head[1]) & 0x7FU;
  if (size >= 126) {
    const std::string length = client.read_bytes(size == 126 ? 2 : 8);
    size = 0;
    for (const char byte : length) size = size << 8U | static_cast<unsigned char>(byte);
  }
  return ServerFrame{.opcode = static_cast<unsigned char>(head[0]) & 0xFU, .payload = client.read_bytes(size)};
}

/// Reads on to the close frame; its code, 0 when there is none.
[[nodiscard]] inline unsigned read_close_code(RawClient& client) {
  while (const auto got = read_frame(client)) {
    if (got->opcode == kClose) return got->close_code();
  }
  return 0;
}

/// A WebSocket after its handshake; not connected when it was refused.
[[nodiscard]] inline std::optional<RawClient> open_websocket(std::uint16_t port, const std::string& more_headers = {},
                                                             int receive_bytes = 0) {
  RawClient client(port, receive_bytes);
  client.send(request(port, "GET /ws", upgrade_headers(port) + more_headers));
  if (status_of(client.read_head()) != "101") return std::nullopt;
  return client;
}

}  // namespace dts::test
