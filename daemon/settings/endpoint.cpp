// SPDX-License-Identifier: Apache-2.0
#include "settings/endpoint.h"

#include <sys/un.h>

#include <charconv>
#include <string_view>

namespace dts::settings {
namespace {

constexpr std::string_view kIpc = "ipc://";
constexpr std::string_view kTcp = "tcp://";
constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

core::Status check_port(const std::string& endpoint) {
  const std::string_view address = std::string_view(endpoint).substr(kTcp.size());
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos)
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' has no port", "write tcp://*:5555");
  const std::string_view digits = address.substr(colon + 1);
  unsigned port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc{} || end != digits.data() + digits.size() || port == 0 || port > 65535) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "': the port must be 1..65535");
  }
  return {};
}

}  // namespace

core::Status check_endpoint(const std::string& endpoint) {
  if (endpoint.starts_with(kTcp)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' is a network address, and dtsd itself has none",
                      "write it under [network], where dts-relay serves clients with keys; here only ipc:// is allowed");
  }
  if (!endpoint.starts_with(kIpc)) return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' is not ipc://");
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
  DTS_TRY(check_port(endpoint));
  const std::string_view host = std::string_view(endpoint).substr(kTcp.size(), endpoint.rfind(':') - kTcp.size());
  const bool is_host = host == "*" || (!host.empty() && host.find_first_not_of("0123456789.") == std::string_view::npos);
  if (is_host) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "'" + endpoint + "' names no address of this machine",
                    "write tcp://*:5555, or the IPv4 address in digits: the address of a name can change");
}

}  // namespace dts::settings
