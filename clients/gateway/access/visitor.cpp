// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/visitor.h"

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>

namespace dts::gateway {

bool is_local(const HttpRequest& request) {
  // What proxies add. A list can be no more than a help: an operator who puts a proxy on this machine gives no local role.
  constexpr std::array kOfProxies{"x-forwarded-for", "forwarded", "x-real-ip", "via"};
  if (std::ranges::any_of(kOfProxies, [&](const char* name) { return request.headers.contains(name); })) return false;
  boost::system::error_code wrong;
  const auto address = boost::asio::ip::make_address(request.remote_address, wrong);
  return !wrong && address.is_loopback();
}

}  // namespace dts::gateway
