// SPDX-License-Identifier: Apache-2.0
#include "ipc/endpoint.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

namespace dts::ipc {
namespace {

constexpr std::string_view kIpc = "ipc://";
constexpr std::string_view kTcp = "tcp://";
constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

core::Status check_tcp(const std::string& endpoint) {
  const std::string_view address = std::string_view(endpoint).substr(kTcp.size());
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' has no port", "write tcp://127.0.0.1:5555");
  }
  const std::string_view digits = address.substr(colon + 1);
  unsigned port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc{} || end != digits.data() + digits.size() || port == 0 || port > 65535) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "': the port must be 1..65535");
  }
  return {};
}

std::string_view host_of(std::string_view endpoint) { return endpoint.substr(kTcp.size(), endpoint.rfind(':') - kTcp.size()); }

}  // namespace

std::string bind_hint(int system_errno) {
  if (system_errno == EADDRNOTAVAIL) {
    return "this machine does not have this address now: write tcp://*:PORT to use all addresses, or correct it in dtsd.toml";
  }
  return system_errno == EADDRINUSE ? "another program listens there: end it, or choose another port in dtsd.toml" : "";
}

core::Status check_endpoint(const std::string& endpoint) {
  if (endpoint.starts_with(kTcp)) {
    if (auto checked = check_tcp(endpoint); !checked || host_of(endpoint) == "127.0.0.1") return checked;
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' is reachable from other machines, which needs client keys",
                      "write it under [network], where clients need keys; here only ipc:// and 127.0.0.1 are allowed");
  }
  if (!endpoint.starts_with(kIpc)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' is neither ipc:// nor tcp://");
  }
  const std::string path = endpoint.substr(kIpc.size());
  if (path.empty() || path.front() != '/') {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "': the socket path must be absolute");
  }
  if (path.size() > kLongestPath) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "'" + endpoint + "': a socket path has at most " + std::to_string(kLongestPath) + " bytes",
                      "choose a shorter runtime directory");
  }
  return {};
}

core::Status check_remote_endpoint(const std::string& endpoint) {
  if (!endpoint.starts_with(kTcp)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' is not tcp://",
                      "write tcp://*:5555, or one address of this machine");
  }
  DTS_TRY(check_tcp(endpoint));
  const std::string_view host = host_of(endpoint);
  const bool is_host = host == "*" || (!host.empty() && host.find_first_not_of("0123456789.") == std::string_view::npos);
  if (is_host) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' names no address of this machine",
                    "write tcp://*:5555, or the IPv4 address in digits: the address of a name can change");
}

core::Status check_not_in_use(const std::string& endpoint) {
  if (!endpoint.starts_with(kIpc)) return {};
  const std::string path = endpoint.substr(kIpc.size());
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.begin(), std::min(path.size(), kLongestPath), std::begin(address.sun_path));
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) return {};  // no such file
  if (!S_ISSOCK(found.st_mode)) {
    return core::fail(core::ErrorCode::InvalidArgument, path + " exists and is not a socket", "choose another path for the endpoint");
  }
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return {};  // no descriptor left: bind will fail and report it
  // EAGAIN: a program listens, but its queue of connections is full.
  const bool is_taken = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN;
  ::close(probe);
  if (is_taken) {
    return core::fail(core::ErrorCode::WrongState, "another program already listens on " + endpoint,
                      "stop the other dtsd, or give this one another runtime directory");
  }
  return {};
}

void remove_socket_file(const std::string& endpoint) noexcept {
  if (endpoint.starts_with(kIpc)) ::unlink(endpoint.c_str() + kIpc.size());
}

}  // namespace dts::ipc
