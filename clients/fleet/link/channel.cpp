// SPDX-License-Identifier: Apache-2.0
#include "fleet/link/channel.h"

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstring>

namespace dts::fleet::link {
namespace {

using Bio = std::unique_ptr<BIO, Destroyer<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Destroyer<X509_free>>;

// What TCP holds beyond what is under way. Without it, TCP takes up to 4 MB: seconds of a slow line, in which nothing else passes.
constexpr int kUnsentBytes = 128 * 1024;
constexpr std::string_view kTls = "tls://";
constexpr std::string_view kPlain = "nats://";

/// The first reason in OpenSSL's queue of this thread, which is empty afterwards.
std::string tls_reason() {
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  const char* const reason = code == 0 ? nullptr : ERR_reason_error_string(code);
  return reason == nullptr ? "unknown reason" : reason;
}

int length_of(std::size_t count) noexcept { return static_cast<int>(std::min<std::size_t>(count, INT_MAX)); }

bool is_ip_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return ::inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 || ::inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

}  // namespace

core::Result<Address> address_of(const std::string& server) {
  Address address{.is_tls = server.starts_with(kTls)};
  const auto wrong = core::fail(core::ErrorCode::InvalidArgument, "the server '" + server + "' is not tls://HOST:PORT");
  if (!address.is_tls && !server.starts_with(kPlain)) return wrong;
  std::string_view rest = std::string_view(server).substr(address.is_tls ? kTls.size() : kPlain.size());
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos) return wrong;
  address.port = rest.substr(colon + 1);
  rest = rest.substr(0, colon);
  if (rest.starts_with('[') && rest.ends_with(']')) rest = rest.substr(1, rest.size() - 2);
  address.host = rest;
  const bool is_number = std::ranges::all_of(address.port, [](char digit) { return digit >= '0' && digit <= '9'; });
  if (address.host.empty() || address.port.empty() || !is_number) return wrong;
  return address;
}

core::Result<std::vector<SocketAddress>> find_host(const Address& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int result = ::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list);
  const std::unique_ptr<addrinfo, Destroyer<::freeaddrinfo>> own(list);
  if (result != 0) return core::fail(core::ErrorCode::Unreachable, "cannot find " + address.host + ": " + ::gai_strerror(result));
  std::vector<SocketAddress> found;
  for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
    if (one->ai_addrlen > sizeof(sockaddr_storage)) continue;
    found.push_back({.length = one->ai_addrlen});
    std::memcpy(&found.back().storage, one->ai_addr, one->ai_addrlen);
  }
  return found;
}

core::Result<TlsContext> make_tls_context(const std::string& ca_pem) {
  TlsContext context(SSL_CTX_new(TLS_client_method()));
  if (context == nullptr) return core::fail(core::ErrorCode::Failed, "cannot prepare TLS: " + tls_reason());
  SSL_CTX_set_min_proto_version(context.get(), TLS1_3_VERSION);
  SSL_CTX_set_mode(context.get(), SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER | SSL_MODE_RELEASE_BUFFERS);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
  const Bio pem(BIO_new_mem_buf(ca_pem.data(), length_of(ca_pem.size())));
  int count = 0;
  for (;; ++count) {
    const Certificate certificate(pem == nullptr ? nullptr : PEM_read_bio_X509(pem.get(), nullptr, nullptr, nullptr));
    if (certificate == nullptr) break;
    if (X509_STORE_add_cert(SSL_CTX_get_cert_store(context.get()), certificate.get()) != 1) break;
  }
  ERR_clear_error();  // the end of the text counts as an error
  if (count == 0) return core::fail(core::ErrorCode::InvalidArgument, "the certificate authority is not a certificate in PEM");
  return context;
}

core::Result<std::unique_ptr<Channel>> Channel::begin(const SocketAddress& address) {
  const int made = ::socket(address.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made < 0) return core::fail_errno(errno, "cannot make a socket");
  std::unique_ptr<Channel> channel(new Channel(made));
  const int yes = 1;
  (void)::setsockopt(made, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  (void)::setsockopt(made, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsentBytes, sizeof(kUnsentBytes));
  if (::connect(made, reinterpret_cast<const sockaddr*>(&address.storage), address.length) != 0 && errno != EINPROGRESS) {
    return core::fail(core::ErrorCode::Unreachable, std::strerror(errno));
  }
  return channel;
}

core::Status Channel::connected() const {
  int error = 0;
  socklen_t length = sizeof(error);
  if (::getsockopt(descriptor(), SOL_SOCKET, SO_ERROR, &error, &length) != 0) error = errno;
  if (error != 0) return core::fail(core::ErrorCode::Unreachable, std::strerror(error));
  return {};
}

core::Status Channel::begin_tls(SSL_CTX* context, const std::string& host) {
  tls_.reset(SSL_new(context));
  const bool is_set =
      tls_ != nullptr && SSL_set_fd(tls_.get(), descriptor()) == 1 &&
      (is_ip_address(host) ? X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls_.get()), host.c_str()) == 1
                           : SSL_set1_host(tls_.get(), host.c_str()) == 1 && SSL_set_tlsext_host_name(tls_.get(), host.c_str()) == 1);
  if (!is_set) return core::fail(core::ErrorCode::Failed, "cannot prepare TLS: " + tls_reason());
  SSL_set_connect_state(tls_.get());
  return {};
}

core::Result<bool> Channel::shake_hands() {
  ERR_clear_error();
  const int result = SSL_do_handshake(tls_.get());
  events_ = 0;
  if (result == 1) return true;
  const int error = SSL_get_error(tls_.get(), result);
  if (error == SSL_ERROR_WANT_WRITE) events_ = POLLOUT;
  if (error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE) return false;
  const long verified = SSL_get_verify_result(tls_.get());
  if (verified != X509_V_OK) {
    ERR_clear_error();
    return core::fail(core::ErrorCode::Unreachable,
                      std::string("the certificate of the server is not accepted: ") + X509_verify_cert_error_string(verified));
  }
  return core::fail(core::ErrorCode::Unreachable, "TLS failed: " + tls_reason());
}

core::Result<std::size_t> Channel::result_of(int result, const char* what) {
  if (result > 0) return static_cast<std::size_t>(result);
  const auto ended = core::fail(core::ErrorCode::Unreachable, "the server has ended the connection");
  if (tls_ == nullptr) {
    if (result < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
    return result == 0 ? ended : core::fail(core::ErrorCode::Unreachable, std::string(what) + ": " + std::strerror(errno));
  }
  const int reason = errno;
  switch (SSL_get_error(tls_.get(), result)) {
    case SSL_ERROR_WANT_READ: return std::size_t{0};
    case SSL_ERROR_WANT_WRITE: events_ = POLLOUT; return std::size_t{0};
    case SSL_ERROR_ZERO_RETURN: return ended;
    case SSL_ERROR_SYSCALL:
      return reason == 0 ? ended : core::fail(core::ErrorCode::Unreachable, std::string(what) + ": " + std::strerror(reason));
    default: return core::fail(core::ErrorCode::Unreachable, std::string(what) + ": " + tls_reason());
  }
}

core::Result<std::size_t> Channel::read(char* bytes, std::size_t count) {
  events_ = 0;
  errno = 0;
  if (tls_ == nullptr) return result_of(static_cast<int>(::recv(descriptor(), bytes, std::min<std::size_t>(count, INT_MAX), 0)), "recv");
  ERR_clear_error();
  return result_of(SSL_read(tls_.get(), bytes, length_of(count)), "TLS");
}

core::Result<std::size_t> Channel::write(std::string_view bytes) {
  if (bytes.empty()) return std::size_t{0};
  events_ = 0;
  errno = 0;
  if (tls_ == nullptr) {
    auto sent =
        result_of(static_cast<int>(::send(descriptor(), bytes.data(), std::min<std::size_t>(bytes.size(), INT_MAX), MSG_NOSIGNAL)), "send");
    if (sent) written_ += *sent;
    return sent;
  }
  ERR_clear_error();
  return result_of(SSL_write(tls_.get(), bytes.data(), length_of(bytes.size())), "TLS");
}

std::uint64_t Channel::written() const noexcept { return tls_ == nullptr ? written_ : BIO_number_written(SSL_get_wbio(tls_.get())); }

std::uint64_t Channel::unacknowledged() const noexcept {
  int bytes = 0;
  return ::ioctl(descriptor(), SIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::uint64_t>(bytes) : 0;
}

}  // namespace dts::fleet::link
