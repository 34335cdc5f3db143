// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dts::gateway {

/// "host" or "host:port", as in a Host header and behind the "://" of an Origin.
struct Authority {
  std::string host;  ///< Lower case; an IPv6 address keeps its brackets.
  std::optional<std::uint16_t> port;
};

/// Returns nothing for any other text: user names, empty hosts, ports out of range, blanks.
[[nodiscard]] std::optional<Authority> parse_authority(std::string_view text);

/// The host names by which a browser may address the gateway. A foreign page that makes its own name point to our address (DNS rebinding)
/// has the same origin as the gateway for the browser; the name in its Host header reveals it.
class HostCheck {
 public:
  HostCheck(std::vector<std::string> host_names, bool is_loopback);

  /// `local_address` is the one that the client connected to. Any port is accepted: a forwarded port is also ours.
  [[nodiscard]] bool is_ours(const Authority& host, std::string_view local_address) const;

 private:
  std::vector<std::string> names_;
};

/// Returns true if `origin` belongs to a page from `host`: same scheme, name and port. "null" matches no host.
[[nodiscard]] bool is_same_origin(std::string_view origin, const Authority& host, bool is_secure);

}  // namespace dts::gateway
