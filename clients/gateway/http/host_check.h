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

/// Nothing for what is not exactly that: user names, empty hosts, ports out of range, blanks.
[[nodiscard]] std::optional<Authority> parse_authority(std::string_view text);

/// By which names a browser may call us. A page of somebody else that made its own name point to our address (DNS rebinding) shares an
/// origin with us in the browser's eyes; the name in its Host header gives it away.
class HostCheck {
 public:
  HostCheck(std::vector<std::string> host_names, bool is_loopback);

  /// `local_address` is the one the connection came to. Any port: one that is forwarded to us is ours as well.
  [[nodiscard]] bool is_ours(const Authority& host, std::string_view local_address) const;

 private:
  std::vector<std::string> names_;
};

/// Whether `origin` is that of a page which came from `host`: same scheme, name and port. "null" is nobody's.
[[nodiscard]] bool is_same_origin(std::string_view origin, const Authority& host, bool is_secure);

}  // namespace dts::gateway
