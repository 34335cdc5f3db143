// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/tcp_link.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <utility>

#include "device/bytes/descriptor_link.h"

namespace dts::device::bytes {
namespace {

using core::ErrorCode;

constexpr std::int64_t kConnectLimitNs = 3 * core::kNanosecondsPerSecond;
constexpr int kLostAfterMs = 10'000;
constexpr int kProbeAfterS = 4;  // of silence
constexpr int kProbeEveryS = 2;
constexpr int kProbes = 3;

constexpr const char* kNetworkHint =
    "the unit of the service has no network: run \"systemctl edit dtsd\", and under [Service] add RestrictAddressFamilies=AF_INET AF_INET6 "
    "and IPAddressAllow= with the address of the board; then restart the service";

struct FreeAddresses {
  void operator()(addrinfo* list) const noexcept { ::freeaddrinfo(list); }
};

/// Reads an address in digits. Returns 0 or an EAI_ number. Asks no name server: the answer may take longer than a rig may be silent.
int find_address(const std::string& host, const std::string& port, addrinfo*& list) noexcept {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  return ::getaddrinfo(host.c_str(), port.c_str(), &wanted, &list);
}

core::Error connect_error(int system_errno, const std::string& name) {
  const std::string what = "cannot connect to " + name + ": ";
  switch (system_errno) {
    case EAFNOSUPPORT:
    case EPERM:
    case EACCES: return {ErrorCode::NotAllowed, what + "the system forbids it (" + std::strerror(system_errno) + ")", kNetworkHint};
    case ETIMEDOUT:
      return {ErrorCode::NotFound, what + "no answer within 3 s",
              std::string("check that the board has power and this address; if dtsd is a service: ") + kNetworkHint};
    case ECONNREFUSED:
      return {ErrorCode::NotFound, what + "nothing listens at this port", "check the port, and that the board's program runs"};
    default: return {ErrorCode::NotFound, what + std::strerror(system_errno), "check the address and the network"};
  }
}

void set_option(int socket, int level, int option, int value) noexcept {
  static_cast<void>(::setsockopt(socket, level, option, &value, sizeof value));  // without one of them the link works, only slower
}

void set_up_socket(int socket) noexcept {
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, kProbeAfterS);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, kProbeEveryS);
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, kProbes);
  set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kLostAfterMs);
}

/// Waits until the connection is made. Returns 0 or an errno.
int finish_connect(int socket, std::int64_t left_ns) noexcept {
  left_ns = std::max<std::int64_t>(left_ns, 0);
  const timespec left{.tv_sec = left_ns / core::kNanosecondsPerSecond, .tv_nsec = left_ns % core::kNanosecondsPerSecond};
  pollfd waiter{.fd = socket, .events = POLLOUT, .revents = 0};
  const int ready = ::ppoll(&waiter, 1, &left, nullptr);
  if (ready <= 0) return ready == 0 ? ETIMEDOUT : errno;
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

class TcpLink final : public DescriptorLink {
 public:
  TcpLink(std::string host, std::uint16_t port, core::Clock& clock)
      : DescriptorLink("TCP port " + std::to_string(port) + " of " + host, clock), host_(std::move(host)), port_(std::to_string(port)) {}
  ~TcpLink() override { TcpLink::close(); }

  core::Status open() override {
    if (is_open()) return {};
    addrinfo* list = nullptr;
    if (const int error = find_address(host_, port_, list); error != 0) {
      return core::fail(ErrorCode::InvalidArgument, "cannot use the address \"" + host_ + "\": " + ::gai_strerror(error),
                        "write the address of the board in digits");
    }
    const std::unique_ptr<addrinfo, FreeAddresses> address(list);
    core::Descriptor socket(::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const int error = socket.get() < 0 ? errno : try_address(socket.get(), *address, clock().now_ns() + kConnectLimitNs);
    if (error == 0) {
      set_up_socket(socket.get());
      attach({.in = std::move(socket), .out_is_socket = true});
      return {};
    }
    return tl::make_unexpected(connect_error(error, name()));
  }

  void close() noexcept override { detach(); }
  /// The network does not say when a board comes: the caller's own retries find it.
  bool has_arrived() noexcept override { return false; }
  Facts facts() const override { return {}; }
  std::string why_lost() const override {
    const auto error = lost();
    if (!error) return {};
    return name() + (*error == 0 ? std::string(": the board closed the connection") : std::string(": ") + std::strerror(*error));
  }
  bool restarts_the_board() const noexcept override { return false; }

 private:
  int try_address(int socket, const addrinfo& address, std::int64_t deadline_ns) const noexcept {
    if (::connect(socket, address.ai_addr, address.ai_addrlen) == 0) return 0;
    return errno == EINPROGRESS ? finish_connect(socket, deadline_ns - clock().now_ns()) : errno;
  }

  std::string host_;
  std::string port_;
};

}  // namespace

core::Result<HostPort> split_host_port(std::string_view text) {
  const auto refuse = [&](const char* why) {
    return core::fail(ErrorCode::InvalidArgument, "address \"" + std::string(text) + "\": " + why,
                      "write HOST:PORT, for example tcp:192.168.1.20:5000 or tcp:[fd00::20]:5000");
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return refuse("has no port");
  std::string_view host = text.substr(0, colon);
  const std::string_view digits = text.substr(colon + 1);
  HostPort found;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), found.port);
  if (error != std::errc{} || end != digits.data() + digits.size() || found.port == 0) return refuse("the port is not 1 to 65535");
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return refuse("an IPv6 address needs brackets");
  }
  if (host.empty()) return refuse("has no host");
  found.host = host == "localhost" ? "127.0.0.1" : host;
  addrinfo* list = nullptr;
  const int unreadable = find_address(found.host, std::string(digits), list);
  const std::unique_ptr<addrinfo, FreeAddresses> address(list);
  if (unreadable != 0) return refuse(("\"" + found.host + "\" is neither an address in digits nor localhost").c_str());
  return found;
}

std::unique_ptr<ByteLink> connect_tcp(std::string host, std::uint16_t port, core::Clock& clock) {
  return std::make_unique<TcpLink>(std::move(host), port, clock);
}

}  // namespace dts::device::bytes
