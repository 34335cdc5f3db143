// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/visitor.h"

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>

namespace dts::gateway {
namespace {

bool is_through_proxy(const HttpRequest& request) {
  // Headers that proxies add. The list cannot be complete: an operator with a proxy on this machine must not set a local role.
  constexpr std::array kOfProxies{"x-forwarded-for", "forwarded", "x-real-ip", "via"};
  return std::ranges::any_of(kOfProxies, [&](const char* name) { return request.headers.contains(name); });
}

}  // namespace

bool is_local(const HttpRequest& request) {
  if (is_through_proxy(request)) return false;
  boost::system::error_code wrong;
  const auto address = boost::asio::ip::make_address(request.remote_address, wrong);
  return !wrong && address.is_loopback();
}

bool is_same_machine(const HttpRequest& request) {
  const bool is_own_address = !request.local_address.empty() && request.remote_address == request.local_address;
  return is_local(request) || (is_own_address && !is_through_proxy(request));
}

}  // namespace dts::gateway
