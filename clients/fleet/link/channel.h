// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/ssl.h>
#include <sys/socket.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/descriptor.h"
#include "core/result.h"

namespace dts::fleet::link {

/// "tls://centre.example.org:4222" or "nats://127.0.0.1:4222".
struct Address {
  bool is_tls = false;
  std::string host{};  ///< Without the brackets of an IPv6 address.
  std::string port{};
};
/// Fails with InvalidArgument.
[[nodiscard]] core::Result<Address> address_of(const std::string& server);

struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t length = 0;
};
/// Asks the resolver, which may take a while. Fails with Unreachable.
[[nodiscard]] core::Result<std::vector<SocketAddress>> find_host(const Address& address);

template <auto destroy>
struct Destroyer {
  template <class T>
  void operator()(T* object) const noexcept {
    destroy(object);
  }
};
using TlsContext = std::unique_ptr<SSL_CTX, Destroyer<SSL_CTX_free>>;
/// TLS 1.3 that trusts the certificates in `ca_pem` and no other. Fails with InvalidArgument if it has none.
[[nodiscard]] core::Result<TlsContext> make_tls_context(const std::string& ca_pem);

/// One TCP connection, with or without TLS. No function waits: 0 means that nothing is possible now, and `events` says for what to poll.
/// Thread: one.
class Channel {
 public:
  /// Begins to connect. It is connected when it can be written to and `connected` succeeds.
  [[nodiscard]] static core::Result<std::unique_ptr<Channel>> begin(const SocketAddress& address);

  [[nodiscard]] int descriptor() const noexcept { return socket_.get(); }
  /// Fails with Unreachable if it could not connect.
  [[nodiscard]] core::Status connected() const;
  /// From now on with TLS. The server must have a certificate for `host`.
  [[nodiscard]] core::Status begin_tls(SSL_CTX* context, const std::string& host);
  /// Returns true when TLS is established. Fails with Unreachable, also if the server's certificate is not accepted.
  [[nodiscard]] core::Result<bool> shake_hands();
  /// Returns the number of bytes. Fails with Unreachable at the end of the connection.
  [[nodiscard]] core::Result<std::size_t> read(char* bytes, std::size_t count);
  [[nodiscard]] core::Result<std::size_t> write(std::string_view bytes);
  /// Events of poll to wait for, besides POLLIN: TLS may have to write before it can read.
  [[nodiscard]] short events() const noexcept { return events_; }

  /// Bytes that were given to TCP so far, with those of TLS.
  [[nodiscard]] std::uint64_t written() const noexcept;
  /// How many of them the other side's TCP has not acknowledged yet.
  [[nodiscard]] std::uint64_t unacknowledged() const noexcept;

 private:
  explicit Channel(int descriptor) : socket_(descriptor) {}
  [[nodiscard]] core::Result<std::size_t> result_of(int result, const char* what);

  core::Descriptor socket_;
  std::unique_ptr<SSL, Destroyer<SSL_free>> tls_;
  std::uint64_t written_ = 0;  ///< Without TLS.
  short events_ = 0;
};

}  // namespace dts::fleet::link
